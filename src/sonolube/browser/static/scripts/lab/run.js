/** The run at work, or the latest: its state, step and time, what it asks, its live channels, and how near its limits are. */
import {html, useEffect, useRef} from '../../vendor/htm-preact-3.1.1.js';
import {useConnection} from '../api.js';
import {short} from '../chart-scale.js';
import {duration} from '../job.js';
import {Button, capital, Card, classes, Warning} from '../parts.js';
import {isAtWork} from './lab.js';
import {Strips, useLive} from './strips.js';

const NEAR = 0.8; // of the way to a limit, from which it is marked
/** Sign of each state beside its word. */
const SIGNS = {preparing: '…', running: '▶', paused: '❚❚', stopping: '◼', safe: '✓', failed: '✕', lost: '✕', completed: '✓', stopped: '◼', refused: '✕'};
const OFF = {failed: 'Cut the power: motor or drive did not confirm that it is off.', lost: 'Cut the power: the program of this run is gone, and nobody knows whether motor and drive are off.'};

/** What the operator is asked; beside the page, so that the stop button stays within reach. */
function Prompt({prompt, confirm}) {
  const dialog = useRef(null);
  useEffect(() => dialog.current.focus(), [prompt.text]);
  return html`<div class="prompt" role="dialog" aria-labelledby="prompt-title" aria-describedby="prompt-text" tabindex="-1" ref=${dialog} data-test="prompt">
    <h2 id="prompt-title">To do: ${prompt.task}</h2><p id="prompt-text">${prompt.text}</p>
    <p class="hint">Motor and drive are off, and the clock of the protocol stands. Is it done?</p>
    ${confirm ? html`<p class="row"><${Button} kind="button is-main" onClick=${() => confirm(true)} data-test="confirm">It is done: go on<//>
      <${Button} onClick=${() => confirm(false)} data-test="not-done">It cannot be done: end the run<//></p>` : html`<p>The tab that holds the laboratory confirms it.</p>`}</div>`;
}

const Limit = ({label, unit, value, limit, share}) => html`<li class=${classes('limit', {'is-near': share >= NEAR})}>
  <span>${capital(label)}</span><meter min="0" max="1" high=${NEAR} optimum="0" value=${Math.min(share ?? 0, 1)} aria-label=${label}></meter>
  <span>${short(value, 3)} of ${short(limit, 3)} ${unit}, <strong>${share == null ? '–' : Math.round(100 * share)} %${share >= NEAR ? ' ⚠ near the limit' : ''}</strong></span></li>`;

/** @param {{run: Object, devices: Object, isHolder: boolean, ask: (what: string, more?: Object) => any}} properties */
export function RunCard({run, devices, isHolder, ask}) {
  const {frame, kept} = useLive(run.id, isAtWork(run));
  const isGone = useConnection().connection !== 'ok';
  const now = {...run, ...(isAtWork(run) && frame)};
  const word = isAtWork(now) ? now.state : now.outcome || now.state;
  const confirm = (isDone) => ask('confirm', {text: now.prompt.text, is_done: isDone});
  return html`<${Card} id="run-title" title=${now.title || now.protocol} data-test="run">
    <p class="row"><span class=${`run-state is-${word}`} role="status" data-test="run-state"><span aria-hidden="true">${SIGNS[word]}</span> ${word}${isGone && ' when last seen'}</span>
      <span data-test="run-step">${now.step && `step ${now.step} of ${now.steps}`}${now.doing && `: ${now.doing.replace(/^step [\d.]+, /, '')}`}</span></p>
    ${OFF[now.state] && html`<${Warning} data-test="cut-power"><strong class="cut-power">${OFF[now.state]}</strong><//>`}
    <p class="row"><progress class="grow" max=${now.total || 1} value=${now.time ?? 0} aria-label="Time of the protocol"></progress>
      <span data-test="run-time">${duration(now.time ?? 0)} of ${duration(now.total ?? 0)}</span>
      ${isHolder && now.state === 'running' && html`<${Button} onClick=${() => ask('pause')} data-test="pause">Pause<//>`}
      ${isHolder && now.is_paused && !now.prompt && html`<${Button} kind="button is-main" onClick=${() => ask('resume')} data-test="resume">Resume<//>`}</p>
    ${now.outcome && now.reason && html`<p data-test="run-reason">Ended: ${now.reason}</p>`}
    ${now.trips?.length > 0 && html`<${Warning}>${now.trips.map((trip) => html`<p key=${trip}>${trip}</p>`)}<//>`}
    ${now.prompt && isAtWork(now) && html`<${Prompt} prompt=${now.prompt} confirm=${isHolder && confirm} />`}
    <${Strips} channels=${devices.channels} kept=${kept} time=${now.time ?? 0} />
    ${isAtWork(now) && frame?.limits?.length > 0 && html`<h3>How near the limits are</h3><ul class="limits" data-test="limits">${frame.limits.map((each) => html`<${Limit} key=${each.label} ...${each} />`)}</ul>`}
    <p class="hint">${now.is_virtual ? `Virtual rig ${now.rig}, seed ${now.seed}` : devices.title}${now.folder && `; recorded in ${now.folder}`}</p>
  <//>`;
}
