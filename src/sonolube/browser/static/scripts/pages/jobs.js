/**
 * Page Jobs and runs: long computations and runs of the laboratory in one list, with their state, results and files.
 */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings} from '../answer.js';
import {ask, useConnection} from '../api.js';
import {Chart} from '../chart.js';
import {duration, isActive, isOwn, JobProgress, progressText, secondsOf} from '../job.js';
import {Button, classes, fileOf, Loading, Refusal, Select, Sheet} from '../parts.js';
import {change, settle, useApp} from '../state.js';
import {offer} from '../take-away.js';

/**
 * @import {Job} from '../job.js'
 * @import {FieldEvent} from '../parts.js'
 * @import {ChangeOptions, Texts} from '../state.js'
 * @typedef {{id: string, title: string, state: string, created: number, duration?: number, device: string, rig?:
 *   string, protocol: string, seed: number|null, recordings: number, version?: string, reason?: string}} RunEntry
 * @typedef {{kind: 'job'|'run', id: string, title: string, state: string, created: number, seconds: number, reason?:
 *   string, task?: string, of?: string, job?: Job}} ListedRow
 */

const [QUICK, SLOW] = [700, 5000]; // ms between looks while a job is active, and otherwise
const KINDS = [
  ['', 'All'],
  ['job', 'Computations'],
  ['run', 'Runs of the laboratory'],
];

/**
 * Reply to a GET, asked again and again; where there is no such address, asked once.
 * @param {string} path
 * @param {(content: any) => boolean} isBusy
 */
function useWatched(path, isBusy) {
  const [found, setFound] = useState(null);
  const [turn, look] = useState(0);
  const {generation} = useConnection();
  useEffect(() => {
    let [timer, isShown] = [0, true];
    ask(path).then(({content, failure}) => {
      if (!isShown) return;
      if (content) setFound(content);
      if (content || failure?.kind === 'offline' || failure?.kind === 'link')
        timer = setTimeout(() => look((old) => old + 1), isBusy(content) ? QUICK : SLOW);
    });
    return () => {
      clearTimeout(timer);
      isShown = false;
    };
  }, [turn, generation]);
  return {found, look: () => look((old) => old + 1)};
}

/**
 * What a run of the laboratory is of, as a line.
 * @param {RunEntry} run
 */
const ofRun = ({device, rig, protocol, seed, recordings, version}) =>
  [
    version && `sonolube ${version}`,
    rig || device,
    rig && device,
    protocol,
    seed != null && `seed ${seed}`,
    recordings > 0 && `${recordings} ${recordings === 1 ? 'recording' : 'recordings'}`,
  ]
    .filter(Boolean)
    .join(', ');

/**
 * Jobs and runs as rows of one list, the latest first.
 * @param {Job[]} jobs
 * @param {RunEntry[]} runs
 */
function listed(jobs, runs) {
  /** @type {ListedRow[]} */
  const rows = [
    ...jobs.map((job) => ({...job, kind: /** @type {const} */ ('job'), title: job.label || job.task, job})),
    ...runs.map((run) => ({...run, kind: /** @type {const} */ ('run'), of: ofRun(run), seconds: run.duration ?? 0})),
  ];
  return rows.sort((one, other) => other.created - one.created);
}

/**
 * Rows that the view asks for.
 * @param {ListedRow[]} rows
 * @param {{kind?: string, search?: string}} view
 */
function filtered(rows, {kind, search = ''}) {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter(
    (row) =>
      (!kind || row.kind === kind) &&
      words.every((word) =>
        [row.title, row.id, row.state, row.task, row.of].some((text) => text?.toLowerCase().includes(word)),
      ),
  );
}

/**
 * Result of a job, or record of a run: figures, text, caveats, files.
 * @param {{kind: 'job'|'run', id: string}} props
 */
function Result({kind, id}) {
  const [reply, setReply] = useState(/** @type {Partial<import('../api.js').Reply>} */ ({}));
  const [request, setRequest] = useState(null);
  useEffect(() => {
    const reading = new AbortController(); // which closing ends
    setReply({});
    ask(kind === 'job' ? `api/jobs/${id}/result` : `api/lab/runs/${id}`, {signal: reading.signal}).then(setReply);
    if (kind === 'job') ask(`api/jobs/${id}`).then(({content}) => setRequest(content?.request));
    return () => reading.abort();
  }, [id]);
  useEffect(() => (request ? offer(request.task, request.arguments) : undefined), [request]);
  const {content, failure} = reply;
  if (failure) return html`<${Refusal} text=${failure.text} role="alert" />`;
  if (!content) return html`<${Loading}>Reading the ${kind === 'run' ? 'recording; Close ends it' : 'result'}…<//>`;
  /** @type {string[]} */
  const files = content.files ?? [];
  return html`<div data-test=${`${kind}-result`}>
    ${drawings(content).map((one) => html`<${Chart} key=${one.name} ...${one} />`)}
    <${Blocks} blocks=${content.blocks} />
    <${Caveats} answer=${content} isMoving=${false} of=${id} hasFields=${false} />
    ${
      files.length > 0 &&
      html`
        <h3>Files</h3>
        <ul class="caveat-list">
          ${files.map(
            (name) => html`<li key=${name} class="is-file">
              <a href=${fileOf(id, name)} download=${name.split('/').at(-1)}>${name}</a>
            </li>`,
          )}
        </ul>
      `
    }
  </div>`;
}

/**
 * What stops or deletes a job.
 * @param {{job: Job, look: () => void, isOpen: boolean}} props
 */
function JobButtons({job, look, isOpen}) {
  const [isAsked, setAsked] = useState(false);
  const name = job.label || job.task;
  const remove = () => {
    if (isOpen) change({view: {job: null}});
    ask(`api/jobs/${job.id}`, {method: 'DELETE'}).then(look);
  };
  const cancel = () => ask(`api/jobs/${job.id}/cancel`, {body: {}}).then(look);
  return html`
    ${
      isActive(job) &&
      isOwn(job) &&
      html`<${Button} onClick=${cancel} aria-label=${`Cancel ${name}`} data-test="cancel-job">Cancel<//>`
    }
    ${
      isOwn(job) &&
      html`<${Button}
        kind="button is-quiet"
        onClick=${isAsked ? remove : () => setAsked(true)}
        onBlur=${() => setAsked(false)}
        aria-label=${`${isAsked ? 'Delete for good:' : 'Delete'} ${name}`}
        data-test="delete-job"
      >
        ${isAsked ? 'Delete for good' : 'Delete'}
      <//>`
    }
  `;
}

/** @param {{row: ListedRow, isOpen: boolean, look: () => void}} props */
function Row({row, isOpen, look}) {
  const {kind, id, title, job} = row;
  const open = () => change({view: {job: null, run: null, ...(!isOpen && {[kind]: id})}});
  return html`<li class=${classes('card job', {'is-open': isOpen})} data-test=${`${kind}:${id}`}>
    <div>
      <h2>${title}</h2>
      <p class="hint">
        ${job ? row.task : `run ${id}`}
        , ${new Date(row.created * 1000).toLocaleString(undefined, {dateStyle: 'medium', timeStyle: 'short'})}
      </p>
      ${row.of && html`<p class="hint" data-test="of">${row.of}</p>`}
      <p class="row">
        <span class=${`tag${['done', 'completed'].includes(row.state) ? ' is-new' : ''}`} data-test=${`${kind}-state`}>
          ${row.state}
        </span>
        ${job && isActive(job) && html`<${JobProgress} job=${job} /><span>${progressText(job)}</span>`}
        ${
          (job ? secondsOf(job) : row.seconds) >= 0.05 &&
          html`<span class="hint">${duration(job ? secondsOf(job) : row.seconds)}</span>`
        }
      </p>
      <${Refusal} text=${row.reason} />
    </div>
    <div class="row">
      ${
        (!job || job.state === 'done') &&
        html`<${Button}
          aria-expanded=${isOpen}
          aria-label=${`${isOpen ? 'Close' : 'Open'} ${title}`}
          onClick=${open}
          data-test=${`open-${kind}`}
        >
          ${isOpen ? 'Close' : 'Open'}
        <//>`
      }
      ${job && html`<${JobButtons} job=${job} look=${look} isOpen=${isOpen} />`}
    </div>
    ${isOpen && html`<div class="job-opened"><${Result} kind=${kind} id=${id} /></div>`}
  </li>`;
}

export default function Jobs() {
  const {
    state: {view},
  } = useApp();
  const {found, look} = useWatched('api/jobs', (content) => content?.jobs.some(isActive));
  const {found: lab} = useWatched('api/lab/runs', () => false);
  /** @type {string[]} */
  const caveats = lab?.caveats ?? [];
  const rows = found ? listed(found.jobs, lab?.runs ?? []) : [];
  const shown = filtered(rows, view);
  /** @param {string} name @param {ChangeOptions} [options] @returns {(event: FieldEvent) => void} */
  const set = (name, options) => (event) => change({view: {[name]: event.target.value || null}}, options);
  return html`<${Sheet} title="Jobs and runs">
    <p class="hint">
      Computations that take longer than a second, and runs of the laboratory. They go on when this page is closed.
    </p>
    ${!found && html`<${Loading}>Reading the jobs…<//>`}
    ${
      found &&
      !rows.length &&
      html`<p class="notice" data-test="no-jobs">
        There are no jobs or runs. The start-up of a rig, on the page Explore, and the page Dissertation start jobs; the
        page Lab starts runs.
      </p>`
    }
    ${
      rows.length > 0 &&
      html`
        <div class="filters" role="search" aria-label="Jobs and runs">
          <div>
            <label for="job-search">Search</label>
            <input
              type="text"
              id="job-search"
              value=${view.search ?? ''}
              onInput=${set('search', {replace: true})}
              onBlur=${settle}
              onChange=${settle}
              autocomplete="off"
              maxlength="200"
              data-test="job-search"
            />
          </div>
          <div>
            <label for="job-kind">Kind</label>
            <${Select}
              id="job-kind"
              choices=${KINDS}
              value=${view.kind ?? ''}
              onChange=${set('kind')}
              data-test="job-kind"
            />
          </div>
          <p role="status" data-test="job-count">${shown.length} of ${rows.length}</p>
        </div>
        ${caveats.map((line) => html`<p key=${line} class="notice is-warning">${line}</p>`)}
        <ul class="jobs" data-test="jobs">
          ${shown.map(
            (row) => html`<${Row}
              key=${row.kind + row.id}
              row=${row}
              look=${look}
              isOpen=${view[row.kind] === row.id && (row.kind === 'run' || row.state === 'done')}
            />`,
          )}
        </ul>
      `
    }
    ${
      found &&
      html`<details>
        <summary>Where they are kept</summary>
        <p class="hint">
          Each computation is a folder in sonolube/${found.folder}, in the folder in which this computer keeps states of
          programs (XDG_STATE_HOME, or ~/.local/state); it is deleted ${found.days} days after its end, or here.${
            lab?.folder &&
            ` Each run is a folder in ${lab.folder}, where the workbench was started; it is deleted by you alone.`
          }
        </p>
      </details>`
    }
  <//>`;
}
