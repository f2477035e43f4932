/** What the scripts use of htm with Preact. Templates are not checked: their holes take anything. */
export type VNode = {readonly type: unknown; readonly props: object; readonly key: unknown};
/** What a component returns, or takes between its tags. */
export type Children = VNode | string | number | boolean | null | undefined | Children[];
export type Ref<T> = {current: T};
type Update<S> = S | ((old: S) => S);
type Effect = () => (() => void) | void;
type Hole = {} | null | undefined | ((...given: any[]) => unknown);

export function html(strings: TemplateStringsArray, ...holes: Hole[]): VNode;
export function render(node: Children, parent: Element): void;
/** A state or reference that begins empty takes anything. */
export function useState(first: null): [any, (next: Hole) => void];
export function useState<S>(first: S | (() => S)): [S, (next: Update<S>) => void];
export function useEffect(effect: Effect, on?: readonly unknown[]): void;
export function useLayoutEffect(effect: Effect, on?: readonly unknown[]): void;
export function useRef(first: null): Ref<any>;
export function useRef<T>(first: T): Ref<T>;
export function useMemo<T>(make: () => T, on?: readonly unknown[]): T;
export function useErrorBoundary(told?: (reason: unknown) => void): [unknown, () => void];
