/**
 * What the laboratory is at: devices, holder and run, asked about while something shows it; and requests to it by this
 * tab.
 */
import {useEffect} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {stored, useListening} from '../state.js';

const BETWEEN = 2000; // ms from one look to the next
/** Name by which the laboratory knows this tab, whatever it shows. */
const HOLDER =
  stored('sessionStorage', 'lab-holder') ??
  stored(
    'sessionStorage',
    'lab-holder',
    [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, '0')).join(''),
  );

/**
 * @typedef {{id: string, state: string, outcome?: string, title?: string, protocol: string, step?: string, steps?:
 *   number, doing?: string, total?: number, time?: number, is_paused?: boolean, reason?: string, outputs?: string,
 *   trips?: string[], prompt?: {number: number, task: string, text: string}|null, is_virtual?: boolean, rig?: string,
 *   seed?: number, folder?: string, stop_link?: string}} Run
 * @typedef {{name: string, label: string, unit: string}} Channel
 * @typedef {{kind: string, title: string, channels: Channel[]}} Devices
 * @typedef {{holder: {is_me: boolean, is_free: boolean}, run: Run|null, devices: Devices, lost: {text: string}|null,
 *   safety: string, protocols: {name: string, title: string}[]}} Laboratory as the server shows it
 */
let lab = /** @type {Laboratory|null} */ (null);
let [users, timer] = [0, 0];
/** @type {Set<() => void>} */
const listeners = new Set();

/** Whether a run has not ended. @param {{state: string}|null} [run] @returns {boolean} */
export const isAtWork = (run) => ['preparing', 'running', 'paused', 'stopping'].includes(run?.state ?? '');

/** Ask how the laboratory is. */
export async function look() {
  const {content} = await ask(`api/lab?holder=${HOLDER}`);
  if (content) lab = content;
  listeners.forEach((listener) => listener());
  clearTimeout(timer);
  if (users) timer = setTimeout(look, BETWEEN);
}

/** The laboratory as it was last seen, followed while a component is shown; null before. */
export function useLab() {
  useListening(listeners);
  useEffect(() => {
    users += 1;
    look();
    return () => {
      users -= 1;
    };
  }, []);
  return lab;
}

/**
 * Ask something of the laboratory as this tab, such as pause; with `isHeld` it takes the laboratory first.
 * @param {string} what
 * @param {object} [more]
 * @param {{isHeld?: boolean, signal?: AbortSignal}} [how]
 * @returns {Promise<import('../api.js').Reply>}
 */
export async function send(what, more, {isHeld = false, signal} = {}) {
  const held = isHeld && !lab?.holder.is_me ? await ask('api/lab/hold', {body: {holder: HOLDER}}) : null;
  const reply = held?.failure ? held : await ask(`api/lab/${what}`, {body: {holder: HOLDER, ...more}, signal});
  await look();
  if (what === 'start') dispatchEvent(new Event('runstart')); // for the stop button, which every page has
  return reply;
}
