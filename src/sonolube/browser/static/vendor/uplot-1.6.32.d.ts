/** What the scripts use of uPlot. */
export type Scale = 'x' | 'y';
type Place = {left: number; top: number};

export default class uPlot {
  constructor(options: object, data: number[][], host: Element | null);
  readonly ctx: CanvasRenderingContext2D;
  readonly bbox: Place & {width: number; height: number};
  readonly width: number;
  readonly height: number;
  destroy(): void;
  redraw(rebuildPaths?: boolean): void;
  setCursor(place: Place, fireHook?: boolean): void;
  setData(data: number[][]): void;
  setSize(size: {width: number; height: number}): void;
}
