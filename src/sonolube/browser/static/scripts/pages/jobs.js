/** Page Jobs: long computations with their state, results and files. */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats} from '../answer.js';
import {ask, useConnection} from '../api.js';
import {Chart} from '../chart.js';
import {duration, isActive, isOwn, JobProgress, progressText, secondsOf} from '../job.js';
import {Button, classes, fileOf, Loading, Refusal, Sheet} from '../parts.js';
import {change, useApp} from '../state.js';

const [QUICK, SLOW] = [700, 5000]; // ms between looks while a job is active, and otherwise

/** All jobs, looked at again and again. */
function useJobs() {
  const [found, setFound] = useState(null);
  const [turn, look] = useState(0);
  const {generation} = useConnection();
  useEffect(() => {
    let timer = 0; // null when no longer shown
    ask('api/jobs').then(({content}) => {
      if (timer === null) return;
      if (content) setFound(content);
      timer = setTimeout(() => look((old) => old + 1), (content ?? found)?.jobs.some(isActive) ? QUICK : SLOW);
    });
    return () => {
      clearTimeout(timer);
      timer = null;
    };
  }, [turn, generation]);
  return {found, look: () => look((old) => old + 1)};
}

/** Result of a job: figures, text, caveats, files. */
function JobResult({id}) {
  const [reply, setReply] = useState({});
  useEffect(() => {
    setReply({});
    ask(`api/jobs/${id}/result`).then(setReply);
  }, [id]);
  const {content, failure} = reply;
  if (failure) return html`<${Refusal} text=${failure.text} role="alert" />`;
  if (!content) return html`<${Loading}>Reading the result…<//>`;
  return html`<div data-test="job-result">
    ${content.charts.filter((one) => one.chart).map((one) => html`<${Chart} key=${one.name} ...${one} />`)}
    <${Blocks} blocks=${content.blocks} />
    <${Caveats} answer=${content} isMoving=${false} of=${id} />
    ${content.files?.length > 0 && html`<h3>Files</h3><ul class="caveat-list">${content.files.map((name) => html`<li key=${name} class="is-file">
      <a href=${fileOf(id, name)} download=${name.split('/').at(-1)}>${name}</a></li>`)}</ul>`}
  </div>`;
}

function Job({job, isOpen, look}) {
  const [isAsked, setAsked] = useState(false);
  const name = job.label || job.task;
  const remove = () => {
    if (isOpen) change({view: {job: null}});
    ask(`api/jobs/${job.id}`, {method: 'DELETE'}).then(look);
  };
  const cancel = () => ask(`api/jobs/${job.id}/cancel`, {body: {}}).then(look);
  return html`<li class=${classes('card job', {'is-open': isOpen})} data-test=${`job:${job.id}`}>
    <div><h2>${name}</h2>
      <p class="hint">${job.task}, ${new Date(job.created * 1000).toLocaleString(undefined, {dateStyle: 'medium', timeStyle: 'short'})}</p>
      <p class="row"><span class=${`tag${job.state === 'done' ? ' is-new' : ''}`} data-test="job-state">${job.state}</span>
        ${isActive(job) && html`<${JobProgress} job=${job} /><span>${progressText(job)}</span>`}
        ${secondsOf(job) >= 0.05 && html`<span class="hint">${duration(secondsOf(job))}</span>`}</p>
      <${Refusal} text=${job.reason} /></div>
    <div class="row">
      ${job.state === 'done' && html`<${Button} aria-expanded=${isOpen} aria-label=${`${isOpen ? 'Close' : 'Open'} ${name}`}
        onClick=${() => change({view: {job: isOpen ? null : job.id}})} data-test="open-job">${isOpen ? 'Close' : 'Open'}<//>`}
      ${isActive(job) && isOwn(job) && html`<${Button} onClick=${cancel} aria-label=${`Cancel ${name}`} data-test="cancel-job">Cancel<//>`}
      ${isOwn(job) && html`<${Button} kind="button is-quiet" onClick=${isAsked ? remove : () => setAsked(true)} onBlur=${() => setAsked(false)}
        aria-label=${`${isAsked ? 'Delete for good:' : 'Delete'} ${name}`} data-test="delete-job">${isAsked ? 'Delete for good' : 'Delete'}<//>`}
    </div>
    ${isOpen && html`<div class="job-opened"><${JobResult} id=${job.id} /></div>`}
  </li>`;
}

export default function Jobs() {
  const {state} = useApp();
  const {found, look} = useJobs();
  return html`<${Sheet} title="Jobs">
    <p class="hint">Computations that take longer than a second. They go on when this page is closed, and are found again after the workbench is
      started again.${found && ` Each is a folder in sonolube/${found.folder}, in the folder in which this computer keeps states of programs
      (XDG_STATE_HOME, or ~/.local/state); it is deleted ${found.days} days after its end, or here.`}</p>
    ${!found && html`<${Loading}>Reading the jobs…<//>`}
    ${found && !found.jobs.length && html`<p class="notice" data-test="no-jobs">There are no jobs. The start-up of a rig, on the page Explore, and the
      page Dissertation start some.</p>`}
    ${found && html`<ul class="jobs" data-test="jobs">${found.jobs.map((job) => html`<${Job} key=${job.id} job=${job}
      isOpen=${state.view.job === job.id && job.state === 'done'} look=${look} />`)}</ul>`}
  <//>`;
}
