/** Shell of the workbench: head with pages, undo, take away and theme; below it the page of the state. */
import {html, render, useEffect, useErrorBoundary, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, enter, useConnection} from './api.js';
import {addressOf, followAddress, PAGES, stored, useApp} from './state.js';
import {TakeAway} from './take-away.js';

const PAGE_TITLES = {predict: 'Predict', explore: 'Explore', dissertation: 'Dissertation', jobs: 'Jobs', new: 'New rig'};
const read = (page) => import(`./pages/${page === 'new' ? 'new-rig' : page}.js`);
const THEMES = ['system', 'light', 'dark'];
const THEME_KEY = 'sonolube-theme';
const storedTheme = () => stored('localStorage', THEME_KEY) ?? THEMES[0];

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  stored('localStorage', THEME_KEY, theme);
  dispatchEvent(new Event('themechange')); // what is drawn on a canvas draws again
}

function ThemeSwitch() {
  const [theme, change] = useState(storedTheme());
  const choose = (event) => {
    setTheme(event.target.value);
    change(event.target.value);
  };
  return html`<label class="theme"><span class="hidden">Theme</span>
    <select value=${theme} onChange=${choose} data-test="theme">
      ${THEMES.map((each) => html`<option value=${each} selected=${each === theme}>
        ${each[0].toUpperCase() + each.slice(1)}</option>`)}
    </select></label>`;
}

function Head() {
  const {state, undo, redo, canUndo, canRedo} = useApp();
  return html`<header class="head">
    <a class="skip" href="#answer" onClick=${skip}>Skip to the answer</a>
    <a class="name" href=${addressOf('predict')}>sonolube</a>
    <nav class="pages" aria-label="Pages">
      ${PAGES.map((page) => html`<a key=${page} href=${addressOf(page)} data-test=${`page:${page}`}
        aria-current=${state.page === page ? 'page' : undefined}>${PAGE_TITLES[page]}</a>`)}
    </nav>
    <div class="tools">
      <button class="icon" type="button" onClick=${undo} disabled=${!canUndo} aria-label="Undo" title="Undo (Ctrl+Z)"
        data-test="undo"><${Arrow} /></button>
      <button class="icon" type="button" onClick=${redo} disabled=${!canRedo} aria-label="Redo"
        title="Redo (Ctrl+Shift+Z)" data-test="redo"><${Arrow} isMirrored=${true} /></button>
      <${TakeAway} />
      <${ThemeSwitch} />
    </div>
  </header>`;
}

const Arrow = ({isMirrored}) => html`<svg viewBox="0 0 20 20" width="18" height="18" aria-hidden="true"
  class=${isMirrored ? 'mirrored' : ''}><path d="M7 4 3 8l4 4M3.5 8H12a4.5 4.5 0 0 1 0 9H8" fill="none"
  stroke="currentColor" stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round" /></svg>`;

function skip(event) {
  event.preventDefault();
  document.getElementById('answer')?.focus();
}

/** What stands above the page while the workbench does not answer. */
function Connection() {
  const {connection} = useConnection();
  const [link, setLink] = useState('');
  const [isWrong, setWrong] = useState(false);
  if (connection === 'ok') return null;
  if (connection === 'offline') {
    return html`<section class="notice is-warning connection" aria-label="Connection" data-test="offline"><p role="alert">
      <strong>No connection.</strong> The workbench does not answer; this page asks again every two seconds. Where it was
      stopped, start it by <code>sonolube app</code>. What you typed and the last answer stay.</p></section>`;
  }
  const submit = async (event) => {
    event.preventDefault();
    setWrong(!(await enter(link)));
  };
  return html`<form class="notice is-warning connection" onSubmit=${submit} aria-label="New link" data-test="new-link">
    <p role="alert"><strong>The workbench was started again.</strong> Paste the link that it printed; this page then goes
      on where it was.</p>
    <div class="row"><label class="grow"><span class="hidden">New link</span>
      <input type="text" value=${link} onInput=${(event) => setLink(event.target.value)} autocomplete="off"
        aria-invalid=${isWrong} aria-describedby=${isWrong ? 'link-refusal' : undefined} placeholder="http://…/?token=…"
        data-test="link" /></label>
      <button type="submit" class="button is-main">Go on</button></div>
    ${isWrong && html`<p id="link-refusal" class="refusal">This is not the link of the workbench that runs now.</p>`}
  </form>`;
}

/** Page of the state; its module is read when it is first shown. */
function Page() {
  const {state} = useApp();
  const [pages, setPages] = useState({});
  const [fault, clear] = useErrorBoundary((reason) => console.error(reason));
  const isFirst = useRef(true);
  const Shown = pages[state.page];
  useEffect(() => {
    clear?.();
    document.title = `${PAGE_TITLES[state.page]} · sonolube`;
    if (!isFirst.current) scrollTo(0, 0);
    isFirst.current = false;
    if (Shown) return;
    const {page} = state;
    read(page).then((module) => module.default, () => Unread).then((shown) => setPages((old) => ({...old, [page]: shown})));
  }, [state.page]);
  if (fault) return html`<${Broken} again=${clear} />`;
  return Shown ? html`<${Shown} />` : html`<div class="page" id="answer" tabindex="-1"><h1>${PAGE_TITLES[state.page]}</h1>
    <p class="loading" role="status">Reading the page…</p></div>`;
}

const Unread = () => html`<div class="page" id="answer" tabindex="-1"><h1>No page</h1>
  <div class="notice is-warning" role="alert">This page could not be read from the workbench. <a href="">Read it again</a></div></div>`;

const Broken = ({again}) => html`<div class="page" id="answer" tabindex="-1"><h1>No answer</h1>
  <div class="notice is-warning" role="alert"><p><strong>This page made a mistake.</strong> What you typed is in the address of
    this page and not lost.</p><button type="button" class="button" onClick=${again}>Draw it again</button></div></div>`;

function Workbench() {
  return html`<${Head} /><${Connection} /><main id="main"><${Page} /></main>`;
}

/** Undo and redo by keys, where no text field has its own. */
function onKey(event) {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  if (event.target.matches?.('input[type=text], textarea')) return;
  const key = event.key.toLowerCase();
  const button = key === 'y' || (key === 'z' && event.shiftKey) ? 'redo' : key === 'z' ? 'undo' : '';
  if (!button) return;
  event.preventDefault();
  document.querySelector(`[data-test=${button}]`)?.click();
}

async function start() {
  setTheme(storedTheme());
  const page = /^#\/(\w+)/.exec(location.hash)?.[1];
  read(PAGES.includes(page) ? page : PAGES[0]).catch(() => null); // while the start is asked for
  let reply = await ask('api/start');
  const root = document.getElementById('app');
  if (!reply.content) {
    root.replaceChildren();
    render(html`<${Connection} />`, root);
  }
  while (!reply.content) {
    await new Promise((done) => setTimeout(done, 1000));
    reply = await ask('api/start');
  }
  await followAddress(reply.content.rig);
  render(null, root);
  root.replaceChildren();
  addEventListener('keydown', onKey);
  render(html`<${Workbench} />`, root);
}

start();
