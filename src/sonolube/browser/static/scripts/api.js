/**
 * Requests of the page: one in flight, of those that wait the latest of each kind next; and whether the workbench answers.
 *
 * @typedef {{key: string, text: string}} Fault
 * @typedef {{text: string, faults: Fault[], kind: 'refused'|'busy'|'offline'|'link'}} Failure
 * @typedef {{content?: any, failure?: Failure}} Reply
 */
import {useEffect, useState} from '../vendor/htm-preact-3.1.1.js';
import {useListening} from './state.js';

const STATED = {'x-status': 'in-header'}; // a refusal is then no error of the browser's console
const RETRY = 2000; // ms between questions whether the workbench is back

/** @type {'ok'|'offline'|'link'} */
let connection = 'ok';
let generation = 0; // counts how often the workbench came back
let timer = 0;
const listeners = new Set();

const SENTENCES = {
  offline: 'The workbench does not answer. Start it again by: sonolube app. What you typed is kept.',
  link: 'The workbench was started again and asks for its new link.',
};

function setConnection(kind) {
  if (kind === connection) return;
  if (kind === 'ok') generation += 1;
  connection = kind;
  clearTimeout(timer);
  if (kind !== 'ok') timer = setTimeout(look, RETRY);
  listeners.forEach((listener) => listener());
}

/** Ask again what hooks have asked. */
export function askAgain() {
  generation += 1;
  listeners.forEach((listener) => listener());
}

/** Ask whether the workbench is back. */
async function look() {
  await send('api/start');
  if (connection !== 'ok') timer = setTimeout(look, RETRY);
}

const failed = (kind, text) => ({failure: {kind, text, faults: [{key: '', text}]}});

/** One request, whatever else is in flight. */
async function send(path, {method = 'GET', body, raw, signal} = {}) {
  let response;
  try {
    response = await fetch(path, {
      method, signal, body: raw ?? (body === undefined ? undefined : JSON.stringify(body)),
      headers: {...STATED, ...(body === undefined ? {} : {'content-type': 'application/json'})},
    });
  } catch (reason) {
    if (signal?.aborted) return failed('busy', 'It was cancelled.');
    setConnection('offline');
    return failed('offline', SENTENCES.offline);
  }
  const status = Number(response.headers.get('x-status') ?? response.status);
  if (status === 401) {
    setConnection('link');
    return failed('link', SENTENCES.link);
  }
  if (status === 502 || status === 504) {
    setConnection('offline');
    return failed('offline', SENTENCES.offline);
  }
  setConnection('ok');
  const text = await response.text().catch(() => '');
  if (!/^[[{]/.test(text)) return failed('busy', text.slice(0, 300) || `the workbench answered ${status}`);
  const content = JSON.parse(text);
  if (status < 300) return {content};
  const kind = status === 422 ? 'refused' : 'busy';
  return {failure: {kind, text: content.text ?? '', faults: content.faults ?? []}};
}

/**
 * GET, POST or DELETE of an address of the workbench.
 * @param {string} path such as "api/jobs"
 * @param {{method?: string, body?: any, signal?: AbortSignal}} [options] a body makes it a POST
 * @returns {Promise<Reply>}
 */
export function ask(path, options = {}) {
  return send(path, {...options, method: options.method ?? (options.body === undefined ? 'GET' : 'POST')});
}

/**
 * Answer of a task.
 * @param {string} name such as "measure friction"
 * @param {Object} args by Python's names
 * @returns {Promise<Reply>}
 */
export const callTask = (name, args, options = {}) => ask(taskPath(name), {...options, body: args});
export const taskPath = (name) => `api/tasks/${name.replaceAll(' ', '/')}`;

/**
 * Upload a file.
 * @param {File} file
 * @returns {Promise<{file?: {name: string, upload: string}, failure?: Failure}>} `file` is the argument of a task.
 */
export async function upload(file) {
  const reply = await send('api/uploads', {method: 'POST', raw: file});
  return reply.failure ? reply : {file: {name: file.name, upload: reply.content.upload}};
}

const waiting = new Map();
/** @type {AbortController|null} */
let inFlight = null;

async function run() {
  if (inFlight) return;
  while (waiting.size) {
    inFlight = new AbortController();
    const [slot, {work, done}] = waiting.entries().next().value;
    waiting.delete(slot);
    done(await work(inFlight.signal));
  }
  inFlight = null;
}

/** Stop the request in flight; the workbench then stops computing its answer. */
export const cancelRequest = () => inFlight?.abort();

/**
 * Do requests one after the other; a newer one of the same slot replaces one that waits.
 * @param {string} slot
 * @param {(signal: AbortSignal) => Promise<Reply>} work
 * @returns {Promise<Reply|null>} null where a newer one took its place
 */
export function inTurn(slot, work) {
  return new Promise((done) => {
    waiting.get(slot)?.done(null);
    waiting.set(slot, {work, done});
    run();
  });
}

/** @type {Map<string, {text: string, reply: Promise<Reply|null>}>} Latest request of each slot, whose reply hooks share. */
const latestOf = new Map();

function shared(slot, text, work) {
  if (latestOf.get(slot)?.text === text) return latestOf.get(slot).reply;
  const reply = inTurn(slot, work);
  latestOf.set(slot, {text, reply});
  reply.then((found) => {
    if (!found?.content && latestOf.get(slot)?.text === text) latestOf.delete(slot);
  });
  return reply;
}

/** @type {Map<string, string>} Last accepted text of each changed entry, by rig and key. */
const accepted = new Map();
const place = (rig, key) => `${rig.text ?? rig.name} ${key}`;

/** Longest of some keys that a sentence names; empty where it names none. */
function named(text, keys) {
  const found = keys.filter((key) => text.includes(`${key}:`));
  return found.sort((one, other) => other.length - one.length)[0] ?? '';
}

/**
 * Ask about a rig; refused entries are replaced by what was accepted last, so that the other fields stay live.
 * @param {string} path
 * @param {{rig?: {name: string, text?: string, changes: Object<string, string>}}} body
 * @param {AbortSignal} signal
 * @returns {Promise<Reply & {refused?: Fault[]}>} `refused` names the entries that were left out
 */
async function askWithRig(path, body, signal) {
  const first = await ask(path, {body, signal});
  const rig = body?.rig;
  if (!rig) return first;
  if (first.content) {
    for (const [key, text] of Object.entries(rig.changes)) accepted.set(place(rig, key), text);
    return first;
  }
  for (const fault of first.failure.faults) fault.key ||= named(fault.text, Object.keys(rig.changes));
  const refused = first.failure.faults.filter((fault) => fault.key in rig.changes);
  if (first.failure.kind !== 'refused' || !refused.length || refused.length < first.failure.faults.length) return first;
  const changes = {...rig.changes};
  for (const {key} of refused) {
    const last = accepted.get(place(rig, key));
    if (last === undefined || last === changes[key]) delete changes[key];
    else changes[key] = last;
  }
  const second = await ask(path, {body: {...body, rig: {...rig, changes}}, signal});
  return second.content ? {...second, refused} : first;
}

/**
 * Answer to the latest request, while an older answer stays.
 * @param {string} slot distinct among the requests of a page
 * @param {string|null} path null asks nothing
 * @param {Object} [body] without one it is a GET
 * @returns {{content: any, failure: Failure|null, refused: Fault[], isWaiting: boolean, of: Object|null}}
 *   `of` is the body that `content` answers.
 */
export function useReply(slot, path, body) {
  const [found, setFound] = useState({content: null, failure: null, refused: [], of: null, text: ''});
  const {generation: turn} = useConnection();
  const text = path === null ? '' : JSON.stringify([path, body, turn]);
  useEffect(() => {
    if (path === null) return;
    shared(slot, text, (signal) => askWithRig(path, body, signal)).then((reply) => {
      if (reply === null) return;
      setFound((old) => (reply.content
        ? {content: reply.content, failure: null, refused: reply.refused ?? [], of: body, text}
        : {...old, failure: reply.failure, refused: [], text}));
    });
  }, [text]);
  return {...found, isWaiting: path !== null && found.text !== text};
}

/**
 * Whether the workbench answers, and how often it came back.
 * @returns {{connection: 'ok'|'offline'|'link', generation: number}}
 */
export function useConnection() {
  useListening(listeners);
  return {connection, generation};
}

/**
 * Let this page in by a new link, without leaving it.
 * @param {string} link as it was printed
 * @returns {Promise<boolean>} whether it is the link of this workbench
 */
export async function enter(link) {
  const token = /[?&]token=([\w-]+)/.exec(link)?.[1] ?? link.trim();
  await fetch(`./?token=${encodeURIComponent(token)}`, {headers: STATED}).catch(() => null);
  await send('api/start');
  return connection === 'ok';
}

/**
 * Whether something has been so for a while, such as waiting for an answer, so that what is short does not flicker.
 * @param {boolean} isSo
 * @param {number} [delay] ms
 */
export function useLate(isSo, delay = 250) {
  const [isLate, setLate] = useState(false);
  useEffect(() => {
    setLate(false);
    const waiting = isSo && setTimeout(() => setLate(true), delay);
    return () => clearTimeout(waiting);
  }, [isSo]);
  return isSo && isLate;
}
