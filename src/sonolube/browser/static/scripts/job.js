/** Long tasks as jobs: found again by what was asked, started, followed, stopped. */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, cancelRequest, useConnection} from './api.js';
import {Button, capital, Warning} from './parts.js';
/**
 * @import {Failure} from './api.js'
 * @typedef {{id: string, task: string, label: string, state: string, created: number, seconds: number, reason?: string,
 *   done?: number, total?: number, stage?: string, request?: {task: string, arguments: object}}} Job
 */

const BETWEEN = 400; // ms from one look at a job to the next
const MAX_COMPARED = 12; // latest jobs of a task whose arguments are compared

/** @param {Job|null} [job] @returns {boolean} */
export const isActive = (job) => ['waiting', 'running', 'running elsewhere'].includes(job?.state ?? '');
/** Whether this workbench runs it, and so can stop it. @param {Job} job @returns {boolean} */
export const isOwn = (job) => job.state !== 'running elsewhere';

/** Seconds that a job has taken. @param {Job} job @returns {number} */
export const secondsOf = (job) => (isActive(job) ? Math.max(0, Date.now() / 1000 - job.created) : job.seconds);

/** Seconds as text. @param {number} seconds @returns {string} */
export function duration(seconds) {
  if (seconds < 60) return `${seconds < 9.95 ? seconds.toFixed(1) : Math.round(seconds)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

/**
 * The latest job of a task with these arguments that was not stopped; undefined where there is none.
 * @param {string} task
 * @param {object} args
 * @returns {Promise<Job|undefined>}
 */
async function found(task, args) {
  const {content} = await ask('api/jobs');
  /** @type {Job[]} */
  const jobs = content?.jobs ?? [];
  const same = jobs.filter((job) => job.task === task && job.state !== 'cancelled' && job.state !== 'interrupted');
  for (const job of same.slice(0, MAX_COMPARED)) {
    const {content: known} = await ask(`api/jobs/${job.id}`);
    if (known && JSON.stringify(known.request.arguments) === JSON.stringify(args)) return known;
  }
  return undefined;
}

/**
 * Job of a task with these arguments, and its result; none is sought for null.
 * @param {string|null} task
 * @param {object} args
 * @returns {{job: Job|null, content: any, isOld: boolean, failure: Failure|null, isSought: boolean,
 *   start: (label: string) => void, cancel: () => void}} `isOld` where the result is of other arguments
 */
export function useJob(task, args) {
  const key = task === null ? '' : JSON.stringify([task, args]);
  /** @type {{key: string, job: Job|null, failure: Failure|null}} */
  const none = {key: '', job: null, failure: null};
  const [state, setState] = useState(none);
  const [result, setResult] = useState({key: '', content: /** @type {any} */ (null)});
  const {generation} = useConnection();
  const latest = useRef(key);
  latest.current = key;
  const isKnown = state.key === key;
  const {job} = isKnown ? state : none;
  /** @param {string} of @param {Job|null|undefined} next @param {Failure} [failure] */
  const enter = (of, next, failure) => {
    if (latest.current === of) setState({key: of, job: next ?? null, failure: failure ?? null});
  };
  useEffect(() => {
    if (task !== null) found(task, args).then((known) => enter(key, known));
  }, [key, generation]);
  useEffect(() => {
    if (!job) return undefined;
    if (job.state === 'done' && result.key !== key) {
      ask(`api/jobs/${job.id}/result`).then(
        ({content}) => content && latest.current === key && setResult({key, content}),
      );
    }
    if (!isActive(job)) return undefined;
    const timer = setTimeout(
      () =>
        ask(`api/jobs/${job.id}`).then(({content, failure}) => {
          if (failure) enter(key, failure.kind === 'refused' ? null : {...job}, failure);
          else enter(key, content);
        }),
      BETWEEN,
    );
    return () => clearTimeout(timer);
  }, [job]);
  /** @param {string} path @param {object} body */
  const post = (path, body) => ask(path, {body}).then(({content, failure}) => enter(key, content ?? job, failure));
  return {
    job,
    content: result.key.startsWith(JSON.stringify([task]).slice(0, -1)) ? result.content : null,
    isOld: result.key !== key,
    failure: isKnown ? state.failure : null,
    isSought: task !== null && !isKnown,
    start: (label) => post('api/jobs', {task, arguments: args, label}),
    cancel: () => job && post(`api/jobs/${job.id}/cancel`, {}),
  };
}

/** What is said of the progress of a job. @param {Job} job @returns {string} */
export function progressText(job) {
  if (job.state === 'waiting') return 'Waits until a running job has ended';
  if (!isActive(job)) return capital(job.state);
  const parts = job.total ? `, ${job.done} of ${job.total}` : '';
  return `${capital((job.total && job.stage) || 'running')}${parts}${isOwn(job) ? '' : ', in another workbench'}`;
}

/** Progress of a job with what stops it; the reason where it failed. @param {{job: Job, cancel?: any}} properties */
export function JobState({job, cancel}) {
  if (!isActive(job)) {
    return job.reason
      ? html`<${Warning} data-test="job-failed"><strong>${progressText(job)}.</strong><p>${job.reason}</p><//>`
      : null;
  }
  return html`<div class="job-state" data-test="job-state">
    <${JobProgress} job=${job} />
    <span role="status">${progressText(job)}</span>
    <span class="hint">${duration(secondsOf(job))}</span>
    ${isOwn(job) && html`<${Button} onClick=${cancel} data-test="cancel-job">Cancel<//>`}
  </div>`;
}

/** @param {{job: Job}} properties */
export const JobProgress = ({job}) =>
  html`<progress ...${job.total && {max: job.total, value: job.done}} aria-label="Progress" />`;

/**
 * Seconds that something already takes, shown after the first with what stops it.
 * @param {{isWaiting: boolean}} properties
 */
export function Waiting({isWaiting}) {
  const [seconds, setSeconds] = useState(0);
  useEffect(() => {
    setSeconds(0);
    if (!isWaiting) return undefined;
    const timer = setInterval(() => setSeconds((old) => old + 1), 1000);
    return () => clearInterval(timer);
  }, [isWaiting]);
  return html`
    <span class="status" role="status" data-test="status">
      ${
        isWaiting &&
        html`
          Computing…${
            seconds > 0 &&
            html` ${seconds} s
              <progress aria-label="Computing" />
            `
          }
        `
      }
    </span>
    ${isWaiting && seconds > 0 && html`<${Button} onClick=${cancelRequest} data-test="cancel-study">Cancel<//>`}
  `;
}
