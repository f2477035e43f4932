/** What several pages draw: buttons, choices, cards, notices; and texts and events that they have in common. */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
/** @typedef {Event & {target: HTMLInputElement}} FieldEvent */

/** @param {string} name @returns {string} */
export const words = (name) => String(name).replaceAll('_', ' ');
/** @param {string} text @returns {string} */
export const capital = (text) => text[0].toUpperCase() + text.slice(1);

/**
 * Class of an element, with those that hold now.
 * @param {string} kind
 * @param {Object<string, any>} more
 * @returns {string}
 */
export const classes = (kind, more) => [kind, ...Object.keys(more).filter((name) => more[name])].join(' ');

/**
 * Button; further properties go to the element.
 * @param {{kind?: string, children: any, [name: string]: any}} properties
 */
export const Button = ({kind = 'button', children, ...rest}) =>
  html`<button type="button" class=${kind} ...${rest}>${children}</button>`;

/**
 * Choice among names, each with its title.
 * @param {{choices: [string, string][], value: string, [name: string]: any}} properties
 */
export const Select = ({choices, value, ...rest}) =>
  html`<select value=${value} ...${rest}>
    ${choices.map(
      ([name, title]) => html`<option key=${name} value=${name} selected=${name === value}>${title}</option>`,
    )}
  </select>`;

/** Page without the rig beside it. @param {{title: string, children: any}} properties */
export const Sheet = ({title, children}) =>
  html`<div class="page" id="answer" tabindex="-1"><h1>${title}</h1>${children}</div>`;

/**
 * Section under a title.
 * @param {{id: string, title: any, kind?: string, isTitleHidden?: boolean, children: any, [name: string]: any}}
 *   properties
 */
export const Section = ({
  id,
  title,
  kind,
  isTitleHidden,
  children,
  ...rest
}) => html`<section class=${kind} aria-labelledby=${id} ...${rest}>
  <h2 id=${id} class=${isTitleHidden ? 'hidden' : undefined}>${title}</h2>
  ${children}
</section>`;

/**
 * Section as a card; dimmed while it is of another state.
 * @param {{isDim?: boolean, kind?: string, [name: string]: any}} properties
 */
export const Card = ({isDim, kind = 'card', ...rest}) =>
  html`<${Section} kind=${classes(kind, {'is-dim': isDim})} ...${rest} />`;

/** @param {{children: any}} props */
export const Loading = ({children}) => html`<p class="loading" role="status">${children}</p>`;

/** @param {{children: any, [name: string]: any}} props */
export const Warning = ({children, ...rest}) =>
  html`<div class="notice is-warning" role="alert" ...${rest}>${children}</div>`;

/** Why something is refused; nothing where it is not. @param {{text?: string|false, [name: string]: any}} properties */
export const Refusal = ({text, ...rest}) => (text ? html`<p class="refusal" ...${rest}>${text}</p>` : null);

/**
 * Button that asks for a file of this computer, or for several.
 * @param {{accept?: string, label: string, onFile?: (file: File) => void, onFiles?: (files: File[]) => void, children:
 *   any, [name: string]: any}} properties
 */
export function FileButton({accept, label, onFile, onFiles, test, children, ...rest}) {
  const chooser = useRef(null);
  /** @param {FieldEvent} event */
  const take = ({target}) => {
    const files = [...(target.files ?? [])];
    if (files.length && onFiles) onFiles(files);
    else if (files.length) onFile?.(files[0]);
    target.value = ''; // so that the same file can be chosen again
  };
  return html`
    <${Button} onClick=${() => chooser.current.click()} ...${rest}>${children}<//>
    <input
      type="file"
      accept=${accept}
      multiple=${Boolean(onFiles)}
      class="hidden"
      tabindex="-1"
      aria-label=${label}
      ref=${chooser}
      onChange=${take}
      data-test=${test}
    />
  `;
}

/**
 * Listen to events of the window while a component is shown.
 * @param {string[]} kinds
 * @param {(event: any) => void} listener
 */
export function useEvents(kinds, listener) {
  const latest = useRef(listener);
  latest.current = listener;
  useEffect(() => {
    /** @param {Event} event */
    const listen = (event) => latest.current(event);
    kinds.forEach((kind) => addEventListener(kind, listen));
    return () => kinds.forEach((kind) => removeEventListener(kind, listen));
  }, []);
}

/** Row that scrolls sideways where there is no room: what is chosen in it stays in view. @param {any} chosen */
export function useInView(chosen) {
  const row = useRef(null);
  useEffect(() => {
    const [here, around] = [row.current.querySelector('[aria-current], :checked'), row.current].map((each) =>
      each?.getBoundingClientRect(),
    );
    if (here) row.current.scrollLeft += here.left + here.width / 2 - around.left - around.width / 2;
  }, [chosen]);
  return row;
}

/**
 * Menu below a button: `place` is for the element around both; it closes by Escape, by a press elsewhere and where
 * `shown` changes.
 * @param {any} [shown]
 */
export function useMenu(shown) {
  const [isOpen, setOpen] = useState(false);
  const place = useRef(null);
  useEvents(['keydown', 'pointerdown'], (event) => {
    const isEscape = event.key === 'Escape' && place.current.contains(document.activeElement);
    if (isEscape) place.current.querySelector('button').focus();
    if (event.key ? isEscape : !place.current.contains(event.target)) setOpen(false);
  });
  useEffect(() => setOpen(false), [shown]);
  return {place, isOpen, toggle: () => setOpen(!isOpen)};
}

/** Sign of a button that opens a menu. */
export const Caret = () => html`<svg viewBox="0 0 10 6" width="10" height="6" class="caret" aria-hidden="true">
  <path d="M1 1 5 5 9 1" fill="none" stroke="currentColor" stroke-width="1.6" stroke-linecap="round" />
</svg>`;

/**
 * Take files that are dropped anywhere on the page; true while some are held over it.
 * @param {(files: File[]) => void} onFiles
 * @returns {boolean}
 */
export function useDrop(onFiles) {
  const [isOver, setOver] = useState(false);
  useEvents(['dragover', 'dragleave', 'drop'], (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    setOver(event.type === 'dragover');
    if (event.type === 'drop') onFiles([...event.dataTransfer.files]);
  });
  return isOver;
}

/** Address of a file of a job. @param {string} id @param {string} name @returns {string} */
export const fileOf = (id, name) => `api/jobs/${id}/files/${name.split('/').map(encodeURIComponent).join('/')}`;
