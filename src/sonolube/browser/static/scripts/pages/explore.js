/** Page Explore: a study of the rig over one or two quantities; a click in its figure sets the rig. */
import {html, useEffect, useMemo, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, Failure, RefusedNote} from '../answer.js';
import {upload, useReply, useTask} from '../api.js';
import {Chart} from '../chart.js';
import {short, split, TextField} from '../fields.js';
import {isActive, JobState, useJob} from '../job.js';
import {useRig, Workspace} from '../rig-panel.js';
import {change, settle, useApp} from '../state.js';
import {offer} from '../take-away.js';

const ENDS = [['from', 'lowest', 'From'], ['to', 'highest', 'To']];
const BODIES = [['pin', 'pin', 'Material of the pin'], ['disc', 'disc', 'Material of the disc']];
const DIGITS = 3;
/** Studies: task, arguments, which entries of the view it takes, and whether it takes seconds and is a job. */
const STUDIES = {
  voltage: {title: 'Voltage', task: 'sweep', args: {of: 'voltage'}, texts: ENDS},
  speed: {title: 'Speed', task: 'sweep', args: {of: 'speed'}, texts: ENDS},
  frequency: {title: 'Frequency', task: 'sweep', args: {of: 'frequency'}, texts: ENDS},
  load: {title: 'Load', task: 'sweep', args: {of: 'load'}, texts: ENDS},
  power: {title: 'Power', task: 'sweep', args: {of: 'power'}, texts: ENDS},
  waveform: {title: 'Waveform', task: 'sweep', args: {of: 'waveform'}},
  period: {title: 'One period', task: 'simulate', args: {}},
  start: {title: 'Start-up', task: 'transient', args: {}, texts: [['duration', 'duration', 'Duration']], isLong: true},
  response: {title: 'Impedance', task: 'response', args: {}, texts: ENDS},
  map: {title: 'Map', task: 'map', args: {}, kinds: true, runs: true},
  heat: {title: 'Temperature', task: 'thermal', args: {}, texts: [['duration', 'duration', 'Duration']], bodies: BODIES},
};
const KINDS = {'velocity-power': 'speed and power', 'velocity-stress': 'speed and stress', 'frequency-voltage': 'frequency and voltage'};

/** Entries set by a click in a map, each as it was set and as the map was drawn with, so that the map stays as it is. */
function fixedOf({view, rig}) {
  try {
    const found = view.study === 'map' ? Object.entries(JSON.parse(view.fixed ?? '{}')) : [];
    return Object.fromEntries(found.filter(([key, [set]]) => rig.changes[key] === set));
  } catch {
    return {}; // a link that was cut off
  }
}

/** Rig that a study is of: that of the state, or the one before the clicks in its map. */
function rigOf(state) {
  const changes = {...state.rig.changes};
  for (const [key, [, before]] of Object.entries(fixedOf(state))) {
    if (before === null) delete changes[key];
    else changes[key] = before;
  }
  return {...state.rig, changes};
}

/** Study that the view names, and its arguments. */
function studyOf(state) {
  const {view} = state;
  const rig = rigOf(state);
  const name = view.study in STUDIES ? view.study : 'voltage';
  const study = STUDIES[name];
  const texts = [...(study.texts ?? []), ...(study.bodies ?? [])].filter(([entry]) => view[entry]);
  const args = {
    rig, ...study.args, ...(study.kinds && {kind: view.kind in KINDS ? view.kind : 'velocity-power'}),
    ...Object.fromEntries(texts.map(([entry, argument]) => [argument, view[entry]])),
    ...(study.runs && view.runs && {runs: runsOf(view)}),
  };
  return {name, study, args};
}

/** Uploaded runs that the view names, as on the page Predict. */
const runsOf = ({runs}) => ({name: runs.slice(runs.indexOf(' ') + 1), upload: runs.split(' ')[0]});

const plain = (label) => label.replaceAll('\n', ' ').toLowerCase();

/** Field of the operating point that an axis shows; undefined where none does. */
function fieldOf(axis, fields) {
  const label = plain(axis.label ?? '');
  const named = (field) => label && (label.endsWith(plain(field.label)) || plain(field.label).endsWith(label));
  return fields.filter((field) => field.is_first).find(named);
}

const textAt = (value, axis) => [short(value, DIGITS), (axis.unit ?? '').replace('µ', 'u')].filter(Boolean).join(' ');

/** Number of a field in the unit of an axis; undefined where the field has another unit. */
function numberOn(axis, field, rig) {
  const parts = field && split(rig.changes[field.key] ?? field.text);
  return parts && parts.rest.trim().replace('µ', 'u') === (axis.unit ?? '').replace('µ', 'u') ? parts.number : undefined;
}

/** Chart with the operating point of the rig: a rule where only x is of the rig, a point where both axes are. */
function withPoint(chart, fields, rig) {
  const panels = chart.panels.map((panel) => {
    const isMap = panel.parts.some((part) => part.kind === 'field');
    const x = numberOn(panel.x, fieldOf(panel.x, fields), rig);
    const y = isMap ? numberOn(panel.y, fieldOf(panel.y, fields), rig) : undefined;
    const known = panel.parts.find((part) => part.kind === 'field' || part.kind === 'line')?.x.filter((value) => value !== null) ?? [];
    const isThere = x !== undefined && x >= Math.min(...known) && x <= Math.max(...known);
    if (!isThere || panel.parts.some((part) => part.kind === 'rule' && part.along === 'x')) return panel;
    const point = y === undefined ? {kind: 'rule', along: 'x', value: x, label: 'operating point', colour: isMap ? '#d55e00' : '#666666', dash: 3}
      : {kind: 'points', x: [x], y: [y], label: 'operating point', colour: '#d55e00', marker: 3, size: 1.6};
    return {...panel, parts: [...panel.parts, point]};
  });
  return {...chart, panels};
}

/** Links to the studies and kinds of maps. */
function Studies({name, view}) {
  const choose = (partial) => change({view: {from: null, to: null, duration: null, fixed: null, ...partial}});
  return html`<fieldset class="choices"><legend>Study</legend>
    ${Object.entries(STUDIES).map(([each, {title}]) => html`<label key=${each} class="choice"><input type="radio" name="study"
      checked=${each === name} onChange=${() => choose({study: each})} data-test=${`study:${each}`} /><span>${title}</span></label>`)}
    </fieldset>
    ${name === 'map' && html`<fieldset class="choices"><legend>Map over</legend>
      ${Object.entries(KINDS).map(([each, title]) => html`<label key=${each} class="choice"><input type="radio" name="kind"
      checked=${each === (view.kind ?? 'velocity-power')} onChange=${() => choose({kind: each})} data-test=${`kind:${each}`} />
      <span>${title}</span></label>`)}</fieldset>`}`;
}

/** Texts that a study takes beside the rig. */
function StudyTexts({study, view, faults}) {
  const fields = study.texts ?? [];
  const materials = useReply('materials', study.bodies ? 'api/tasks/materials' : null, useMemo(() => ({}), []));
  const names = Object.entries(materials.content?.answer ?? {});
  if (!fields.length && !study.bodies) return null;
  const faultOf = (argument) => faults.find((fault) => fault.key === argument)?.text;
  return html`<div class="study-texts">${fields.map(([entry, argument, label]) => html`<div key=${entry} class="field">
      <label for=${`study-${entry}`}>${label}</label>
      <${TextField} id=${`study-${entry}`} text=${view[entry] ?? ''} onText=${(text, isMoving) => !isMoving && change({view: {[entry]: text.trim() || null}})}
        onSettle=${settle} placeholder="usual" aria-invalid=${faultOf(argument) ? 'true' : undefined}
        aria-describedby=${faultOf(argument) ? `study-${entry}-refusal` : undefined} data-test=${`study-text:${entry}`} />
      ${faultOf(argument) && html`<p class="refusal" id=${`study-${entry}-refusal`}>${faultOf(argument)}</p>`}</div>`)}
    ${(study.bodies ?? []).map(([entry, argument, label]) => html`<div key=${entry} class="field"><label for=${`study-${entry}`}>${label}</label>
      <select id=${`study-${entry}`} value=${view[entry] ?? ''} onChange=${(event) => change({view: {[entry]: event.target.value || null}})}
        aria-describedby=${faultOf(argument) ? `study-${entry}-refusal` : undefined} data-test=${`study-text:${entry}`}><option value="" selected=${!view[entry]}>as in the rig</option>
        ${names.map(([each, {title}]) => html`<option key=${each} value=${each} selected=${each === view[entry]}>${title}</option>`)}</select>
      ${faultOf(argument) && html`<p class="refusal" id=${`study-${entry}-refusal`}>${faultOf(argument)}</p>`}</div>`)}
  </div>`;
}

/** Own runs on a map. */
function OwnRuns({view}) {
  const chooser = useRef(null);
  const [note, setNote] = useState('');
  const take = async (file) => {
    if (!file) return;
    const {file: uploaded, failure} = await upload(file);
    setNote(failure?.text ?? '');
    if (uploaded) change({view: {runs: `${uploaded.upload} ${uploaded.name}`}});
  };
  return html`<div class="row study-runs"><button type="button" class="button" onClick=${() => chooser.current.click()} data-test="choose-runs">
      ${view.runs ? 'Other own runs…' : 'Own runs…'}</button>
    ${view.runs && html`<span>${runsOf(view).name}</span><button type="button" class="small" onClick=${() => change({view: {runs: null}})}
      data-test="remove-runs">leave out</button>`}
    <input type="file" accept=".csv,.txt" class="hidden" tabindex="-1" aria-label="Own runs" ref=${chooser}
      onChange=${(event) => take(event.target.files[0])} data-test="runs-file" />
    ${note && html`<p class="refusal" role="alert">${note}</p>`}</div>`;
}

/** Seconds that something already takes, shown after the first. */
function Waiting({isWaiting}) {
  const [seconds, setSeconds] = useState(0);
  useEffect(() => {
    setSeconds(0);
    if (!isWaiting) return undefined;
    const timer = setInterval(() => setSeconds((old) => old + 1), 1000);
    return () => clearInterval(timer);
  }, [isWaiting]);
  return html`<span class="status" role="status" data-test="status">${isWaiting && html`Computing…${seconds > 0 && html` ${seconds} s
    <progress aria-label="Computing" />`}`}</span>`;
}

/** Answer of a study: at once, or as a job where it takes long; while the rig moves, that of the last rest. */
function useStudy(study, args, isMoving) {
  const rest = useRef(args);
  if (!isMoving) rest.current = args;
  const asked = rest.current;
  const direct = useTask(study.isLong ? null : study.task, asked, 'study');
  const job = useJob(study.isLong ? study.task : null, asked);
  if (study.isLong) {
    return {content: job.content, failure: job.failure, refused: [], isWaiting: isActive(job.job) || job.isSought, isOld: job.isOld || isMoving, job, of: asked};
  }
  return {...direct, isOld: isMoving || direct.isWaiting || Boolean(direct.failure), job: null};
}

export default function Explore() {
  const {state, isMoving} = useApp();
  const {view: rigView} = useRig();
  const {name, study, args} = studyOf(state);
  const {content, failure, refused, isWaiting, isOld, job, of} = useStudy(study, args, isMoving);
  const [note, setNote] = useState('');
  const fields = rigView?.fields ?? [];
  const text = JSON.stringify(args);
  useEffect(() => offer(study.task, args), [text]);
  useEffect(() => setNote(''), [name, state.view.kind]);
  const isOfStudy = content && (study.isLong || sameStudy(of, args));
  const charts = useMemo(() => (isOfStudy ? content.charts.filter((one) => one.chart).map((one) => ({...one, chart: withPoint(one.chart, fields, state.rig)})) : []),
    [content, isOfStudy, rigView, JSON.stringify(state.rig)]);
  const own = [...(study.texts ?? []), ...(study.bodies ?? [])].map(([, argument]) => argument);
  const faults = (failure?.faults ?? []).map((fault) => ({...fault, key: fault.key || (own.find((argument) => fault.text.startsWith(argument)) ?? '')}));
  const start = () => job.start(`${study.title}: ${rigView?.title ?? state.rig.name}`);
  const lead = html`<p class="overline">Explore</p>
    <h1 class="statement">Choose an operating point</h1>
    <${Studies} name=${name} view=${state.view} />`;
  return html`<${Workspace} lead=${lead}>
    <${StudyTexts} study=${study} view=${state.view} faults=${faults} />
    ${study.runs && html`<${OwnRuns} view=${state.view} />`}
    ${study.isLong && html`<div class="row">${job.isOld && !isActive(job.job) && !job.isSought && html`<button type="button" class="button is-main" onClick=${start}
      data-test="start-job">${content ? 'Compute again' : 'Compute'}</button>
      <span class="hint">${content ? 'The figure is of the rig before.' : 'Takes some seconds.'}</span>`}
      ${job.job && html`<${JobState} job=${job.job} cancel=${job.cancel} />`}</div>`}
    <div class="row study-status">${!study.isLong && html`<${Waiting} isWaiting=${isWaiting} />`}
      ${note && html`<span role="status" class="status" data-test="picked">${note}</span>`}
      ${Object.keys(fixedOf(state)).length > 0 && html`<span class="hint">Map and caveats are of the rig before the click.</span>
        <button type="button" class="small" onClick=${() => change({view: {fixed: null}})} data-test="draw-anew">Draw anew</button>`}</div>
    <${Failure} failure=${failure && {...failure, faults}} shown=${Object.keys(state.rig.changes)} /><${RefusedNote} refused=${refused} />
    ${!isOfStudy && !failure && !study.isLong && html`<div class="skeleton" aria-hidden="true"></div>`}
    ${isOfStudy && html`<div aria-busy=${isWaiting} data-test="study">
      ${charts.map((one) => html`<${Chart} key=${one.name} name=${one.name} caption=${one.caption} chart=${one.chart} tables=${one.tables}
        dimmed=${isOld} onPick=${(at) => setNote(pick(at, one.chart, fields, state))} canPick=${(panel) => Boolean(pickedOf(one.chart.panels[panel], fields).length)} />`)}
      <div class="columns"><div class="stack"><section class=${`card${isOld ? ' is-dim' : ''}`} aria-labelledby="study-numbers">
        <h2 id="study-numbers">Result</h2><${Blocks} blocks=${content.blocks} /></section></div>
        <div class="stack"><section class="card" aria-label="Caveats and assumptions"><h2 class="hidden">Caveats and assumptions</h2><${Caveats} answer=${content} isMoving=${isMoving || isWaiting} of=${JSON.stringify(of)} /></section></div></div>
    </div>`}
  <//>`;
}

/** Whether an answer is of the same study, whatever its rig. */
const sameStudy = (one, other) => JSON.stringify([one?.of, one?.kind, Object.keys(one ?? {})]) === JSON.stringify([other.of, other.kind, Object.keys(other)]);

/** Axes of a panel that are of the rig: those of x, and of y where a field lies over both. */
function pickedOf(panel, fields) {
  const names = panel.parts.some((part) => part.kind === 'field') ? ['x', 'y'] : ['x'];
  return names.map((name) => [name, fieldOf(panel[name], fields)]).filter(([, field]) => field);
}

/** Set the rig to a place of a panel; returns what is said of it. */
function pick(at, chart, fields, state) {
  const panel = chart.panels[at.panel];
  const found = pickedOf(panel, fields).map(([name, field]) => [field, textAt(at[name], panel[name])]);
  if (!found.length) return '';
  const {rig} = state;
  const drawn = rigOf(state).changes;
  const isMap = panel.parts.some((part) => part.kind === 'field');
  const fixed = {...fixedOf(state), ...Object.fromEntries(found.map(([field, text]) => [field.key, [text, drawn[field.key] ?? null]]))};
  const changes = {...rig.changes, ...Object.fromEntries(found.map(([field, text]) => [field.key, text]))};
  change({rig: {...rig, changes}, ...(isMap && {view: {fixed: JSON.stringify(fixed)}})});
  return `Set ${found.map(([field, text]) => `${field.label} to ${text}`).join(' and ')}.`;
}
