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

let [lab, users, timer] = [null, 0, 0];
const listeners = new Set();

/** Whether a run has not ended. @param {{state: string}|null} [run] @returns {boolean} */
export const isAtWork = (run) => ['preparing', 'running', 'paused', 'stopping'].includes(run?.state);

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
 * @returns {Promise<import('../api.js').Reply>}
 */
export async function send(what, more, {isHeld = false, signal} = {}) {
  const held = isHeld && !lab?.holder.is_me ? await ask('api/lab/hold', {body: {holder: HOLDER}}) : {};
  const reply = held.failure ? held : await ask(`api/lab/${what}`, {body: {holder: HOLDER, ...more}, signal});
  await look();
  if (what === 'start') dispatchEvent(new Event('runstart')); // for the stop button, which every page has
  return reply;
}
