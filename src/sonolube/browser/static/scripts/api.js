/**
 * Requests of the page: one in flight, of those that wait the latest of each kind next; and whether the workbench
 * answers.
 *
 * @typedef {{key: string, text: string}} Fault
 * @typedef {{text: string, faults: Fault[], kind: 'refused'|'busy'|'offline'|'link'}} Failure
 * @typedef {{content: any, failure?: undefined}|{content?: undefined, failure: Failure}} Reply an answer or a failure
 * @typedef {Reply & {refused?: Fault[]}} Answered `refused` names the entries that were left out
 * @typedef {'ok'|'offline'|'link'} Link
 */
import {useEffect, useState} from '../vendor/htm-preact-3.1.1.js';
import {present, useListening} from './state.js';

const STATED = {'x-status': 'in-header'}; // a refusal is then no error of the browser's console
const RETRY = 2000; // ms between questions whether the workbench is back
const LATE = 250; // ms

/** @type {Link} */
let connection = 'ok';
let generation = 0; // counts how often the workbench came back
let timer = 0;
/** @type {Set<() => void>} */
const listeners = new Set();
const tell = () => listeners.forEach((listener) => listener());

/** Statuses of a workbench, or of a proxy before it, that has no answer. */
/** @type {Record<number, 'link'|'offline'>} */
const GONE = {401: 'link', 502: 'offline', 504: 'offline'};
const SENTENCES = {
  offline: 'The workbench does not answer. Start it again by: sonolube app. What you typed is kept.',
  link: 'The workbench was started again and asks for its new link.',
};

/** @param {Link} kind */
function setConnection(kind) {
  if (kind === connection) return;
  if (kind === 'ok') generation += 1;
  connection = kind;
  clearTimeout(timer);
  if (kind !== 'ok') timer = setTimeout(look, RETRY);
  tell();
}

/** Ask again what hooks have asked. */
export function askAgain() {
  generation += 1;
  tell();
}

/** Ask whether the workbench is back. */
async function look() {
  await ask('api/start');
  if (connection !== 'ok') timer = setTimeout(look, RETRY);
}

/** @param {Failure['kind']} kind @param {string} text @returns {Reply} */
const failed = (kind, text) => ({failure: {kind, text, faults: [{key: '', text}]}});

/** @param {'link'|'offline'} kind */
function gone(kind) {
  setConnection(kind);
  return failed(kind, SENTENCES[kind]);
}

/**
 * GET, POST or DELETE of an address of the workbench, whatever else is in flight.
 * @param {string} path such as "api/jobs"
 * @param {{method?: string, body?: any, raw?: Blob, signal?: AbortSignal}} [options] a body makes it a POST, of JSON or
 *   raw
 * @returns {Promise<Reply>}
 */
export async function ask(path, {method, body, raw, signal} = {}) {
  const json = body === undefined ? undefined : JSON.stringify(body);
  let response;
  try {
    response = await fetch(path, {
      method: method ?? (raw || json ? 'POST' : 'GET'),
      signal,
      body: raw ?? json,
      headers: {...STATED, ...(json && {'content-type': 'application/json'})},
    });
  } catch (reason) {
    return signal?.aborted ? failed('busy', 'It was cancelled.') : gone('offline');
  }
  const status = Number(response.headers.get('x-status') ?? response.status);
  if (status in GONE) return gone(GONE[status]);
  setConnection('ok');
  const text = await response.text().catch(() => '');
  if (!/^[[{]/.test(text)) return failed('busy', text.slice(0, 300) || `the workbench answered ${status}`);
  const content = JSON.parse(text);
  if (status < 300) return {content};
  const kind = status === 422 ? 'refused' : 'busy';
  return {failure: {kind, text: content.text ?? '', faults: content.faults ?? []}};
}

/**
 * Answer of a task, such as "measure friction", to arguments by Python's names.
 * @param {string} name
 * @param {object} args
 * @returns {Promise<Reply>}
 */
export const callTask = (name, args) => ask(taskPath(name), {body: args});
/** @param {string} name @returns {string} */
export const taskPath = (name) => `api/tasks/${name.replaceAll(' ', '/')}`;

/** @type {Map<string, {work: (signal: AbortSignal) => Promise<Answered>, done: (reply: Answered|null) => void}>} */
const waiting = new Map();
/** @type {AbortController|null} */
let inFlight = null;

async function run() {
  if (inFlight) return;
  for (const [slot, {work, done}] of waiting) {
    inFlight = new AbortController();
    waiting.delete(slot);
    done(await work(inFlight.signal));
  }
  inFlight = null;
}

/** Stop the request in flight; the workbench then stops computing its answer. */
export const cancelRequest = () => inFlight?.abort();

/**
 * Do requests one after the other; a newer one of the same slot replaces one that waits, whose reply is then null.
 * @param {string} slot
 * @param {(signal: AbortSignal) => Promise<Answered>} work
 * @returns {Promise<Answered|null>}
 */
export const inTurn = (slot, work) =>
  new Promise((done) => {
    waiting.get(slot)?.done(null);
    waiting.set(slot, {work, done});
    run();
  });

/**
 * Latest request of each slot, whose reply hooks share.
 * @type {Map<string, {text: string, reply: Promise<Answered|null>}>}
 */
const latestOf = new Map();

/** @param {string} slot @param {string} text @param {(signal: AbortSignal) => Promise<Answered>} work */
function shared(slot, text, work) {
  const latest = latestOf.get(slot);
  if (latest?.text === text) return latest.reply;
  const reply = inTurn(slot, work);
  latestOf.set(slot, {text, reply});
  reply.then((found) => {
    if (!found?.content && latestOf.get(slot)?.text === text) latestOf.delete(slot);
  });
  return reply;
}

/** @type {Map<string, string>} Last accepted text of each changed entry, by rig and key. */
const accepted = new Map();
/** @param {import('./state.js').RigState} rig @param {string} key */
const place = (rig, key) => `${rig.text ?? rig.name} ${key}`;

/**
 * Longest of some keys that a sentence names; empty where it names none.
 * @param {string} text
 * @param {string[]} keys
 */
const named = (text, keys) =>
  keys.filter((key) => text.includes(`${key}:`)).sort((one, other) => other.length - one.length)[0] ?? '';

/**
 * Ask about a rig; refused entries are replaced by what was accepted last, so that the other fields stay live.
 * @param {string} path
 * @param {any} body
 * @param {AbortSignal} signal
 * @returns {Promise<Answered>}
 */
async function askWithRig(path, body, signal) {
  const first = await ask(path, {body, signal});
  /** @type {import('./state.js').RigState|undefined} */
  const rig = body?.rig;
  if (!rig) return first;
  const {failure} = first;
  if (!failure) {
    for (const [key, text] of Object.entries(rig.changes)) accepted.set(place(rig, key), text);
    return first;
  }
  for (const fault of failure.faults) fault.key ||= named(fault.text, Object.keys(rig.changes));
  const refused = failure.faults.filter((fault) => fault.key in rig.changes);
  if (failure.kind !== 'refused' || !refused.length || refused.length < failure.faults.length) return first;
  /** @param {string} key */
  const last = (key) => accepted.get(place(rig, key));
  const replaced = refused.map(({key}) => [key, last(key) === rig.changes[key] ? null : last(key)]);
  const changes = present({...rig.changes, ...Object.fromEntries(replaced)});
  const second = await ask(path, {body: {...body, rig: {...rig, changes}}, signal});
  return second.content ? {...second, refused} : first;
}

/**
 * @typedef {{content: any, failure: Failure|null, refused: Fault[], of: any}} Answer `of` is the body that is answered
 */
/**
 * Answer to the latest request of a slot, while an older answer stays; null for a path asks nothing, no body is a GET.
 * @param {string} slot
 * @param {string|null} path
 * @param {any} [body]
 * @returns {Answer & {isWaiting: boolean}}
 */
export function useReply(slot, path, body) {
  /** @type {Answer & {text: string}} */
  const nothing = {content: null, failure: null, refused: [], of: null, text: ''};
  const [found, setFound] = useState(nothing);
  const {generation: turn} = useConnection();
  const text = path === null ? '' : JSON.stringify([path, body, turn]);
  useEffect(() => {
    if (path === null) return;
    shared(slot, text, (signal) => askWithRig(path, body, signal)).then(
      (reply) =>
        reply &&
        setFound((old) =>
          reply.failure
            ? {...old, failure: reply.failure, refused: [], text}
            : {content: reply.content, failure: null, refused: reply.refused ?? [], of: body, text},
        ),
    );
  }, [text]);
  return {...found, isWaiting: path !== null && found.text !== text};
}

/**
 * Whether the workbench answers, and how often it came back.
 * @returns {{connection: Link, generation: number}}
 */
export function useConnection() {
  useListening(listeners);
  return {connection, generation};
}

/**
 * Let this page in by a new link, as it was printed, without leaving it; false where it is of another workbench.
 * @param {string} link
 * @returns {Promise<boolean>}
 */
export async function enter(link) {
  const token = /[?&]token=([\w-]+)/.exec(link)?.[1] ?? link.trim();
  await fetch(`./?token=${encodeURIComponent(token)}`, {headers: STATED}).catch(() => null);
  await ask('api/start');
  return connection === 'ok';
}

/**
 * Whether something has been so for a while, such as waiting for an answer, so that what is short does not flicker.
 * @param {boolean} isSo
 * @returns {boolean}
 */
export function useLate(isSo) {
  const [isLate, setLate] = useState(false);
  useEffect(() => {
    setLate(false);
    const waiting = isSo ? setTimeout(() => setLate(true), LATE) : 0;
    return () => clearTimeout(waiting);
  }, [isSo]);
  return isSo && isLate;
}
