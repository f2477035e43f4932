/**
 * State of the workbench: which page, which rig with which changes, and what the page shows. It lies in the fragment of
 * the address, so that a link, a reload or a restart gives the same screen; undo and redo go over the whole of it.
 *
 * @typedef {Record<string, string>} Texts
 * @typedef {Record<string, string|null>} Edits texts to enter, null for those to remove
 * @typedef {{name: string, text?: string, changes: Texts}} RigState
 * @typedef {{page: string, rig: RigState, view: Texts}} State
 * @typedef {{replace?: boolean}} ChangeOptions
 */
import {useLayoutEffect, useState} from '../vendor/htm-preact-3.1.1.js';

/** Pages by their names in an address, with their titles. */
/** @type {Texts} */
export const PAGES = {
  predict: 'Predict',
  explore: 'Explore',
  data: 'Data',
  modes: 'Modes',
  design: 'Design',
  lab: 'Lab',
  jobs: 'Jobs',
  dissertation: 'Dissertation',
  new: 'New rig',
};
/** Pages that the head shows at all times, by what is done on them. @type {Texts} */
export const DOORS = {predict: 'Predict', data: 'Measure', design: 'Design', lab: 'Run'};
const STEPS = 100; // of undo
const LONGEST_TEXT = 8192; // characters of a compressed rig file that a link holds
const KEPT_PREFIX = 'kept-';
const WITH_RIG = ['predict', 'explore', 'design']; // pages that share some entries of their views
const SHARED = ['runs', 'pin', 'disc', 'lubricant', 'lost'];

/** @type {State} */
let state = {page: 'predict', rig: {name: '', changes: {}}, view: {}};
let fragment = '';
/** @type {string|null} Fragment before a value began to move. */
let before = null;
let isMoving = false;
const listeners = new Set();
/** Compressed form of each rig text, and the way back. */
const packed = new Map();

const tell = () => listeners.forEach((listener) => listener());

/**
 * Value that a store of the browser holds, or is given; a full or forbidden store forgets, no more.
 * @param {'sessionStorage'|'localStorage'} store
 * @param {string} name
 * @param {string} [value]
 * @returns {string|undefined}
 */
export function stored(store, name, value) {
  try {
    if (value !== undefined) globalThis[store].setItem(name, value);
    return globalThis[store].getItem(name) ?? undefined;
  } catch {
    return value;
  }
}
/** Fragments to undo and to redo. */
let [past, future] = JSON.parse(stored('sessionStorage', 'history') ?? '[[], []]');
const keep = () => stored('sessionStorage', 'history', JSON.stringify([past, future]));
/** View of each page when it was last shown, with what the pages of the rig share. */
const views = JSON.parse(stored('sessionStorage', 'views') ?? '{}');
function remember() {
  const {page, view} = state;
  views[page] = view;
  if (WITH_RIG.includes(page))
    WITH_RIG.forEach((each) => SHARED.forEach((name) => (views[each] = present({...views[each], [name]: view[name]}))));
  stored('sessionStorage', 'views', JSON.stringify(views));
}

/** Draw a component again whenever a set of listeners is told. @param {Set<() => void>} to */
export function useListening(to) {
  const [, draw] = useState({});
  useLayoutEffect(() => {
    const listener = () => draw({});
    to.add(listener);
    return () => to.delete(listener);
  }, []);
}

/**
 * Text as bytes through a stream of the browser, as base64url or back.
 * @param {CompressionStream|DecompressionStream} stream
 * @param {Uint8Array<ArrayBuffer>} bytes
 */
const through = async (stream, bytes) =>
  new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());

/**
 * Compress the text of a rig so that a link can hold it, and give its code; a long one is kept by this tab only.
 * @param {string} text
 * @returns {Promise<string>}
 */
export async function pack(text) {
  const bytes = await through(new CompressionStream('deflate-raw'), new TextEncoder().encode(text));
  const binary = Array.from(bytes, (byte) => String.fromCharCode(byte)).join('');
  let code = btoa(binary).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  if (code.length > LONGEST_TEXT) {
    code = KEPT_PREFIX + code.slice(-24) + code.length;
    stored('sessionStorage', code, text);
  }
  packed.set(text, code);
  return code;
}

/** Whether the text of a rig is too long for a link. @param {string} [text] @returns {boolean} */
export const isOfTab = (text) => Boolean(packed.get(text)?.startsWith(KEPT_PREFIX));

/**
 * Text of a code of `pack`; undefined where this tab no longer keeps it.
 * @param {string} code
 * @returns {Promise<string|undefined>}
 */
export async function unpack(code) {
  const read = async () => {
    const binary = atob(code.replaceAll('-', '+').replaceAll('_', '/'));
    const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
    return new TextDecoder().decode(await through(new DecompressionStream('deflate-raw'), bytes));
  };
  const text = code.startsWith(KEPT_PREFIX) ? stored('sessionStorage', code) : await read();
  if (text !== undefined) packed.set(text, code);
  return text;
}

/** @param {string} text */
const quoted = (text) => encodeURIComponent(text).replaceAll('%20', '+').replaceAll('%3A', ':').replaceAll('%2F', '/');

/** Fragment of a state, without its hash. @param {State} of @returns {string} */
export function encode(of) {
  const parts = [
    ...(of.rig.name ? [['rig', of.rig.name]] : []),
    ...(of.rig.text === undefined ? [] : [['text', packed.get(of.rig.text) ?? '']]),
    ...Object.entries(of.rig.changes).map(([key, text]) => ['set', `${key}:${text}`]),
    ...Object.entries(of.view),
  ];
  const query = parts.map(([name, text]) => `${name}=${quoted(text)}`).join('&');
  return `/${of.page}${query && `?${query}`}`;
}

/** State of a fragment; what it lacks is empty. @param {string} of @returns {Promise<State>} */
export async function decode(of) {
  const [path, query = ''] = of.replace(/^#/, '').split(/\?(.*)/s);
  const page = path.replace(/^\//, '');
  /** @type {State} */
  const found = {page: Object.hasOwn(PAGES, page) ? page : 'predict', rig: {name: '', changes: {}}, view: {}};
  for (const [name, text] of new URLSearchParams(query)) {
    if (name === 'rig') found.rig.name = text;
    else if (name === 'text') found.rig.text = await unpack(text).catch(() => undefined);
    else if (name === 'set') {
      const end = text.indexOf(':');
      if (end > 0) found.rig.changes[text.slice(0, end)] = text.slice(end + 1);
    } else found.view[name] = text;
  }
  return found;
}

/**
 * Entries of a record that are not null.
 * @template T
 * @param {Record<string, T>} entries
 * @returns {Record<string, NonNullable<T>>}
 */
export const present = (entries) =>
  /** @type {any} */ (Object.fromEntries(Object.entries(entries).filter(([, value]) => value != null)));

/**
 * Change parts of the state; entries of `view` and `rig.changes` that are null are removed. With `replace` (a value
 * that moves) there is no entry of history until `settle` or the next change.
 * @param {{page?: string, rig?: {name: string, text?: string, changes: Edits}, view?: Edits}} partial
 * @param {ChangeOptions} [options]
 */
export function change({page = state.page, rig = state.rig, view}, {replace = false} = {}) {
  const shown = page === state.page ? state.view : {};
  state = {page, rig: {...rig, changes: present(rig.changes)}, view: present({...shown, ...view})};
  if (replace) {
    before ??= fragment;
    isMoving = true;
    fragment = encode(state);
    tell();
  } else commit();
}

/** Enter what has moved into the history. */
export const settle = () => isMoving && commit();

function commit() {
  if (enter(encode(state))) history.pushState(null, '', `#${fragment}`);
  remember();
  tell();
}

/**
 * Make a fragment that of now, the one before it a step to undo; false where it is the same.
 * @param {string} to
 */
function enter(to) {
  const from = before ?? fragment;
  before = null;
  isMoving = false;
  fragment = to;
  if (from === to) return false;
  past = [...past, from].slice(-STEPS);
  future = [];
  keep();
  return true;
}

/**
 * Set an entry of the rig, or take its change back with null; options as of `change`.
 * @param {string} key
 * @param {string|null} text
 * @param {ChangeOptions} [options]
 */
export const setEntry = (key, text, options) =>
  change({rig: {...state.rig, changes: {...state.rig.changes, [key]: text}}}, options);

/** @type {(found: State) => Promise<void>} Called with the state of a step before it is shown. */
let adapt = async () => {};
/** @param {(found: State) => Promise<void>} called */
export const onStep = (called) => {
  adapt = called;
};

/** @param {string[]} from @param {string[]} onto */
async function step(from, onto) {
  settle();
  const to = from.pop();
  if (to === undefined) return;
  onto.push(fragment);
  const found = await decode(to);
  await adapt(found);
  state = found;
  fragment = encode(state);
  keep();
  history.replaceState(null, '', `#${fragment}`);
  remember();
  tell();
}

export const undo = () => step(past, future);
export const redo = () => step(future, past);

/** Address of a page with the rig of now, for a link. @param {string} page @param {Texts} [view] @returns {string} */
export const addressOf = (page, view = {}) => `#${encode({page, rig: state.rig, view})}`;
/** Address of a page as it was left, for a link. @param {string} page @returns {string} */
export const addressAsLeft = (page) => addressOf(page, page === state.page ? state.view : views[page]);

/**
 * Read the state from the address, and follow it; an address without a rig gets the one that was opened.
 * @param {string} opened
 * @returns {Promise<void>}
 */
export async function followAddress(opened) {
  const read = async () => {
    const found = await decode(location.hash);
    if (/[?&]text=/.test(location.hash) && found.rig.text === undefined) {
      found.view = {lost: found.rig.name};
      found.rig = {name: '', changes: {}};
    }
    if (!found.rig.name) found.rig.name = opened;
    return found;
  };
  state = await read();
  fragment = encode(state);
  history.replaceState(null, '', `#${fragment}`);
  addEventListener('popstate', async () => {
    const found = await read();
    if (encode(found) === fragment) return;
    state = found;
    enter(encode(state));
    remember();
    tell();
  });
  remember();
  tell();
}

/** State, for a component that is drawn again when it changes. */
export function useApp() {
  useListening(listeners);
  return {state, isMoving, canUndo: past.length > 0, canRedo: future.length > 0};
}

/** Page as it is now. @returns {string} */
export const pageNow = () => state.page;

/** Name of the rig as it is now. @returns {string} */
export const rigNow = () => state.rig.name;

/** Set entries of the view without a step to undo. @param {Edits} view */
export function amend(view) {
  state = {...state, view: present({...state.view, ...view})};
  fragment = encode(state);
  history.replaceState(null, '', `#${fragment}`);
  remember();
  tell();
}

/** Entry of the view as it is now, whatever was drawn last. @param {string} name @returns {string|undefined} */
export const entryNow = (name) => state.view[name];
