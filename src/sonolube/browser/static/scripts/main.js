/** Shell of the workbench: head with pages, undo, take away and theme; below it the page of the state. */
import {html, render, useEffect, useErrorBoundary, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, enter, useConnection} from './api.js';
import {followFolder, openFolder} from './folder-runs.js';
import {
  Button,
  capital,
  Caret,
  Loading,
  Refusal,
  Select,
  Sheet,
  useEvents,
  useInView,
  useMenu,
  Warning,
} from './parts.js';
import {addressAsLeft, addressOf, DOORS, followAddress, PAGES, redo, stored, undo, useApp} from './state.js';
import {TakeAway} from './take-away.js';

/** Pages with styles of their own, in `pages/` beside the scripts. */
const STYLED = new Set(['data', 'modes', 'design', 'lab', 'jobs', 'dissertation']);

/**
 * Module of a page, or another one that has its styles, read with them.
 * @param {string} page
 * @param {string} path
 */
function read(page, path = `./pages/${page === 'new' ? 'new-rig' : page}.js`) {
  const module = import(path);
  if (!STYLED.delete(page)) return module;
  const link = Object.assign(document.createElement('link'), {rel: 'stylesheet', href: `static/pages/${page}.css`});
  const styles = new Promise((done) => Object.assign(link, {onload: done, onerror: done}));
  document.head.append(link);
  return styles.then(() => module);
}

/** Pages below "More", with what they are for. @type {Record<string, string>} */
const BESIDE = {
  new: 'a first rig from questions',
  explore: 'studies and maps of the rig',
  modes: 'horns and parts',
  jobs: 'computations and runs',
  dissertation: 'its claims, judged',
};

const THEMES = ['system', 'light', 'dark'];
const THEME_KEY = 'sonolube-theme';
const storedTheme = () => stored('localStorage', THEME_KEY) ?? THEMES[0];

/** @param {string} theme */
function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  stored('localStorage', THEME_KEY, theme);
  drawAgain();
}

const drawAgain = () => dispatchEvent(new Event('themechange')); // what is drawn on a canvas
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAgain);

const ThemeSwitch = () => html`<label class="theme">
  <span class="grow">Theme</span>
  <${Select}
    choices=${THEMES.map((each) => [each, capital(each)])}
    value=${document.documentElement.dataset.theme}
    onChange=${(event) => setTheme(event.target.value)}
    data-test="theme"
  />
</label>`;

function Head() {
  const {state, canUndo, canRedo} = useApp();
  const links = useInView(state.page);
  useEvents(['keydown'], onKey);
  useEvents(['dragover', 'drop'], stay);
  return html`<header class="head">
    <a class="skip" href="#answer" onClick=${skip}>Skip to the answer</a>
    <a class="name" href=${addressOf('predict')} data-test="home">sonolube</a>
    <nav class="pages" aria-label="Pages">
      <div class="doors" ref=${links}>
        ${Object.entries(DOORS).map(([page, title]) => html`<${Door} key=${page} page=${page} title=${title} />`)}
        ${!(state.page in DOORS) && html`<${Door} page=${state.page} title=${PAGES[state.page]} />`}
      </div>
      <${More} page=${state.page} />
    </nav>
    <div class="tools">
      <${Step} name="Undo" keys="Ctrl+Z" step=${undo} can=${canUndo} />
      <${Step} name="Redo" keys="Ctrl+Shift+Z" step=${redo} can=${canRedo} kind="mirrored" />
      <${Examples} />
      <${TakeAway} />
    </div>
  </header>`;
}

/** Button that opens the gallery of examples, whose module is read when it is first pressed. */
function Examples() {
  const [Gallery, setGallery] = useState(null);
  const [isOpen, setOpen] = useState(false);
  const open = async () => {
    const {default: shown} = await import('./gallery.js');
    setGallery(() => shown);
    setOpen(true);
  };
  return html`
    <${Button} onClick=${open} aria-haspopup="dialog" aria-label="Examples" title="Examples" data-test="examples">
      <svg viewBox="0 0 16 16" width="16" height="16" class="examples-sign" aria-hidden="true">
        <path d="M1 1h6v6H1z M9 1h6v6H9z M1 9h6v6H1z M9 9h6v6H9z" fill="none" stroke="currentColor" />
      </svg>
      <span class="examples-word">Examples</span>
    <//>
    ${Gallery && isOpen && html`<${Gallery} onClose=${() => setOpen(false)} />`}
  `;
}

/**
 * Link to a page as it was left.
 * @param {{page: string, title: string, kind?: string, children?: any}} props
 */
const Door = ({page, title, kind = 'door', children}) => html`<a
  class=${kind}
  href=${addressAsLeft(page)}
  data-test=${`page:${page}`}
  aria-current=${useApp().state.page === page ? 'page' : undefined}
>
  ${title}${children}
</a>`;

/**
 * Menu of the pages without a door, and the theme.
 * @param {{page: string}} props
 */
function More({page}) {
  const {place, isOpen, toggle} = useMenu(page);
  return html`<div class="take is-more" ref=${place}>
    <${Button} kind="door" aria-expanded=${isOpen} aria-haspopup="true" onClick=${toggle} data-test="more">
      More <${Caret} />
    <//>
    ${
      isOpen &&
      html`<div class="menu" role="group" aria-label="More pages">
        ${Object.entries(BESIDE)
          .filter(([each]) => each !== page)
          .map(
            ([each, note]) => html`<${Door} key=${each} page=${each} title=${PAGES[each]} kind="menu-item">
              <span class="hint">${note}</span>
            <//>`,
          )}
        <${ThemeSwitch} />
      </div>`
    }
  </div>`;
}

/** @param {{name: string, keys: string, step: () => void, can: boolean, kind?: string}} props */
const Step = ({name, keys, step, can, kind = ''}) => html`<${Button}
  kind="icon"
  onClick=${step}
  disabled=${!can}
  aria-label=${name}
  title=${`${name} (${keys})`}
  data-test=${name.toLowerCase()}
>
  <svg viewBox="0 0 20 20" width="18" height="18" aria-hidden="true" class=${kind}>
    <path
      d="M7 4 3 8l4 4M3.5 8H12a4.5 4.5 0 0 1 0 9H8"
      fill="none"
      stroke="currentColor"
      stroke-width="1.8"
      stroke-linecap="round"
      stroke-linejoin="round"
    />
  </svg>
<//>`;

/** @param {Event} event */
function skip(event) {
  event.preventDefault();
  document.getElementById('answer')?.focus();
}

/**
 * Keep the browser from leaving the page for a file that is dropped where no page takes it.
 * @param {DragEvent} event
 */
function stay(event) {
  if (event.dataTransfer?.types.includes('Files')) event.preventDefault();
}

/** What stands above the page while the workbench does not answer. */
function Connection() {
  const {connection} = useConnection();
  const [link, setLink] = useState('');
  const [isWrong, setWrong] = useState(false);
  if (connection === 'ok') return null;
  if (connection === 'offline') {
    return html`<section class="notice is-warning connection" aria-label="Connection" data-test="offline">
      <p role="alert">
        <strong>No connection.</strong> The workbench does not answer; this page asks again every two seconds. Where it
        was stopped, start it by <code>sonolube app</code>. What you typed and the last answer stay.
      </p>
    </section>`;
  }
  /** @param {Event} event */
  const submit = async (event) => {
    event.preventDefault();
    setWrong(!(await enter(link)));
  };
  return html`<form class="notice is-warning connection" onSubmit=${submit} aria-label="New link" data-test="new-link">
    <p role="alert">
      <strong>The workbench was started again.</strong> Paste the link that it printed; this page then goes on where it
      was.
    </p>
    <div class="row">
      <label class="grow">
        <span class="hidden">New link</span>
        <input
          type="text"
          value=${link}
          onInput=${(event) => setLink(event.target.value)}
          autocomplete="off"
          aria-invalid=${isWrong}
          aria-describedby=${isWrong ? 'link-refusal' : undefined}
          placeholder="http://…/?token=…"
          data-test="link"
        />
      </label>
      <button type="submit" class="button is-main">Go on</button>
    </div>
    <${Refusal} id="link-refusal" text=${isWrong && 'This is not the link of the workbench that runs now.'} />
  </form>`;
}

/** Page of the state; its module is read when it is first shown. */
function Page() {
  const {state} = useApp();
  const [pages, setPages] = useState(/** @type {Record<string, any>} */ ({}));
  const [fault, clear] = useErrorBoundary((reason) => console.error(reason));
  const isFirst = useRef(true);
  const Shown = pages[state.page];
  useEffect(() => {
    clear?.();
    if (!isFirst.current) scrollTo(0, 0);
    isFirst.current = false;
    if (Shown) return;
    const {page} = state;
    read(page)
      .then(
        (module) => module.default,
        () => Unread,
      )
      .then((shown) => setPages((old) => ({...old, [page]: shown})));
  }, [state.page]);
  useEffect(() => {
    document.title = `${PAGES[state.page]} · ${state.rig.name} · sonolube`;
  }, [state.page, state.rig.name]);
  if (fault) return html`<${Broken} again=${clear} />`;
  if (Shown) return html`<${Shown} />`;
  return html`<${Sheet} title=${PAGES[state.page]}><${Loading}>Reading the page…<//><//>`;
}

const Unread = () => html`<${Sheet} title="No page">
  <${Warning}>This page could not be read from the workbench. <a href="">Read it again</a><//>
<//>`;

/** @param {{again: () => void}} props */
const Broken = ({again}) => html`<${Sheet} title="No answer">
  <${Warning}>
    <p><strong>This page made a mistake.</strong> What you typed is in the address of this page and not lost.</p>
    <${Button} onClick=${again}>Draw it again<//>
  <//>
<//>`;

const BETWEEN = 5000; // ms between looks whether a run is at work

/** Stop button of a run of the laboratory, on every page; its module is read when a run is at work. */
function AtWork() {
  const [Stop, setStop] = useState(null);
  const look = async () => {
    if (!Stop && (await ask('api/start')).content?.is_running)
      setStop(
        await read('lab', './lab/stop.js').then(
          (module) => () => module.default,
          () => null,
        ),
      );
  };
  useEvents(['runstart'], look);
  useEffect(() => {
    look();
    const timer = Stop ? 0 : setInterval(look, BETWEEN);
    return () => clearInterval(timer);
  }, [Stop]);
  return Stop && html`<${Stop} />`;
}

/**
 * Undo and redo by keys, where no text field has its own.
 * @param {KeyboardEvent & {target: Element}} event
 */
function onKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  if (event.target.matches?.('input[type=text], textarea')) return;
  const key = event.key.toLowerCase();
  const step = key === 'y' || (key === 'z' && event.shiftKey) ? redo : undo;
  if (key !== 'y' && key !== 'z') return;
  event.preventDefault();
  step();
}

const WITH_RUNS = ['predict', 'explore', 'design', 'data'];

/** Keeps the table of own runs of these pages that of the folder of the rig, where one is open. */
function FolderRuns() {
  const {
    state: {page, rig, view},
  } = useApp();
  useEffect(() => {
    if (WITH_RUNS.includes(page)) followFolder();
  }, [page, rig.name, view.runs]);
  return null;
}

async function start() {
  setTheme(storedTheme());
  const page = /^#\/(\w+)/.exec(location.hash)?.[1] ?? '';
  read(Object.hasOwn(PAGES, page) ? page : 'predict').catch(() => null); // while the start is asked for
  let reply = await ask('api/start');
  const root = /** @type {HTMLElement} */ (document.getElementById('app'));
  if (!reply.content) {
    root.replaceChildren();
    render(html`<${Connection} />`, root);
  }
  while (!reply.content) {
    await new Promise((done) => setTimeout(done, 1000));
    reply = await ask('api/start');
  }
  await followAddress(reply.content.rig);
  if (reply.content.is_folder) await openFolder(reply.content.rig);
  render(null, root);
  root.replaceChildren();
  render(html`<${AtWork} /><${FolderRuns} /><${Head} /><${Connection} /><main id="main"><${Page} /></main>`, root);
}

start();
