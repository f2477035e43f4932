/** A recording: its channels over time with the parts that are measured, what a task finds in them, and where that goes. */
import {html, useEffect} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, Failure} from '../answer.js';
import {Chart} from '../chart.js';
import {short} from '../chart-scale.js';
import {Labelled, refusedBy, TextField} from '../fields.js';
import {Button, Card, Loading, Select} from '../parts.js';
import {settle} from '../state.js';
import {offer} from '../take-away.js';
import {Columns} from './columns.js';
import {mappingOf, useMeasured} from './files.js';
import {Trace} from './trace.js';
import {Use} from './use.js';

/** Tasks: title, channels of which one is needed, texts that they take (those with a star are needed), whether parts can be stated. */
const TASKS = {
  friction: ['Friction', /^friction_(force|coefficient)$/, {window: 'Window', rotation_speed: 'Turns of the disc per time'}],
  rotation: ['Rotation', /^magnetic_flux_density$/, {groove_diameter: 'Diameter of the circle under the pin *', magnets: 'Magnets'}],
  temperature: ['Temperature', /^temperature$/, {start_time: 'Step of the heat at', end_time: 'End of the response'}],
  calibration: ['Calibration of a force gauge', /^displacement$/, {degree: 'Degree of the polynomials'}],
  vibration: ['Vibration', /./, {frequency: 'Frequency of the drive *'}],
};
const COUNTS = new Set(['magnets', 'degree']);
const CONDITIONS = {sliding_speed: 'Sliding speed', normal_load: 'Load', voltage_peak_to_peak: 'Voltage, peak to peak', vibration_amplitude: 'Amplitude'};
const MAX_SHOWN = 3; // channels

/** Task of a recording: the chosen one, else the first that its channels allow. */
const nameOf = (own, {channels = []}) => own.task ?? Object.keys(TASKS).find((name) => channels.some((each) => TASKS[name][1].test(each.name)));

const span = ({from, to}) => `${Number(from.toPrecision(9))}s:${Number(to.toPrecision(9))}s`;

/** What measures a recording; null where something is missing that it needs. @param {import('./files.js').DataFile} file @param {object} own @param {object} info @returns {import('./files.js').Asked|null} */
export function taskOf(file, own, info) {
  const name = nameOf(own, info);
  const texts = Object.entries(TASKS[name][2]);
  if (texts.some(([key, label]) => label.endsWith('*') && !own[key])) return null;
  const given = Object.fromEntries(texts.filter(([key]) => own[key]).map(([key]) => [key, COUNTS.has(key) ? Number(own[key]) : own[key]]));
  const marks = own.marks ?? [];
  const of = (kind) => marks.filter((mark) => mark.kind === kind);
  const parts = name !== 'friction' ? {} : {
    ...(own.sliding_speed && {sliding_speed: own.sliding_speed}), ...(of('part').length && {part: span(of('part')[0])}), ...(of('rest').length && {rest: of('rest').map(span)}),
    ...(of('step').length && {step: Object.fromEntries(of('step').map((mark) => [span(mark), mark.voltage || '0 V']))}),
  };
  return {task: `measure ${name}`, args: {files: file, ...mappingOf(own.mapping), ...given, ...parts}};
}

/** Steps that the task has found, as marks; none where they are stated. */
const foundSteps = (content) => (content?.answer.results?.[0]?.tables?.steps?.rows ?? [])
  .map((row) => ({kind: 'step', from: row.start_time, to: row.end_time, voltage: `${short(row.voltage_peak_to_peak)} V`}));

/** Marks with their names. */
const named = (marks) => marks.map((mark, at) => ({...mark, at, id: `${mark.kind}${marks.slice(0, at).filter(({kind}) => kind === mark.kind).length + 1}`}))
  .map((mark) => ({...mark, label: mark.kind === 'step' ? mark.voltage || 'step' : mark.kind === 'part' ? 'measured' : 'rest'}));

/** Parts of a friction recording: a list with voltages, and what adds one. */
function Parts({marks, isFound, enter, range}) {
  const add = (kind) => {
    const [from, to] = [range[0] + (range[1] - range[0]) / 3, range[1] - (range[1] - range[0]) / 3];
    enter([...(kind === 'step' || !isFound ? marks : marks.filter((mark) => mark.kind !== 'step')), {kind, from, to, ...(kind === 'step' && {voltage: '0 V'})}]);
  };
  const write = (at, voltage) => enter(marks.map((mark, place) => (place === at ? {...mark, voltage} : mark)));
  return html`<div class="data-parts" role="group" aria-label="Parts">
    ${isFound && html`<p class="hint">Steps as found in the voltage; drag an end to state them.</p>`}
    <ul>${named(marks).map(({at, id, kind, label, from, to, voltage}) => html`<li key=${id} class="row"><span class=${`tag is-${kind}`}>${kind}</span> ${short(from, 5)} to ${short(to, 5)} s
      ${kind === 'step' && !isFound && html`<${TextField} id=${`voltage-${id}`} text=${voltage} unit="V" aria-label=${`Voltage of ${id}`} data-test=${`voltage:${id}`}
        onText=${(text, isMoving) => !isMoving && write(at, text)} onSettle=${settle} />`}
      ${kind === 'step' && isFound && voltage}
      ${!isFound || kind !== 'step' ? html`<${Button} kind="small" onClick=${() => enter(marks.filter((_, place) => place !== at))} aria-label=${`Remove ${id}, ${label}`}>remove<//>` : ''}</li>`)}</ul>
    <p class="row">${[['step', 'Add a step'], ['rest', 'Add a rest'], ['part', 'Measure a part']].map(([kind, title]) => html`<${Button} key=${kind}
      disabled=${kind === 'part' && marks.some((mark) => mark.kind === 'part')} onClick=${() => add(kind)} data-test=${`add:${kind}`}>${title}<//>`)}</p></div>`;
}

export default function Recording({file, own, set, info, asked}) {
  const {content, failure, isWaiting} = useMeasured(file, asked);
  useEffect(() => asked && offer(asked.task, asked.args), [JSON.stringify(asked)]);
  if (info.reason) return html`<${Columns} file=${file} own=${own} set=${set} info=${info} />`;
  const name = nameOf(own, info);
  const isFriction = name === 'friction' && info.axis.name === 'time';
  const stated = own.marks ?? [];
  const isFound = isFriction && !stated.some(({kind}) => kind === 'step');
  const marks = [...stated, ...(isFound ? foundSteps(content) : [])];
  const range = own.range ?? [info.begin, info.end];
  const enter = (some, options) => set({marks: some.length ? some : null}, options);
  const onMark = (mark, end, value, isMoving) => {
    if (!isMoving) return settle();
    const others = marks.filter(({kind}, at) => at !== mark.at && kind === mark.kind);
    const least = end === 'to' ? mark.from : Math.max(info.begin, ...others.filter(({to}) => to <= mark.to).map(({to}) => to));
    const most = end === 'from' ? mark.to : Math.min(info.end, ...others.filter(({from}) => from >= mark.from).map(({from}) => from));
    return enter(marks.map((each, at) => (at === mark.at ? {...each, [end]: Math.min(Math.max(value, least), most)} : each)), {replace: true});
  };
  const wanted = info.channels.map((each, at) => [TASKS[name][1].test(each.name) ? 0 : /voltage|speed|velocity/.test(each.name) ? 1 : 2, at]);
  const shown = own.shown ?? wanted.sort(([one, a], [other, b]) => one - other || a - b).map(([, at]) => at).slice(0, MAX_SHOWN);
  const show = (at) => set({shown: shown.includes(at) ? shown.filter((each) => each !== at) : [...shown, at]});
  const faultOf = (key) => failure?.faults.find((fault) => fault.key === key || fault.text.startsWith(key))?.text;
  const texts = (entries) => Object.entries(entries).map(([key, label]) => html`<${Labelled} key=${key} id=${`set-${key}`} label=${label} refusal=${faultOf(key)}>
    <${TextField} id=${`set-${key}`} text=${own[key] ?? ''} data-test=${`set:${key}`} onText=${(text, isMoving) => !isMoving && set({[key]: text.trim() || null})} onSettle=${settle}
      ...${refusedBy(`set-${key}`, faultOf(key))} /><//>`);
  const source = content?.answer.results ? {results: content.answer.results, conditions: Object.fromEntries(Object.keys(CONDITIONS).filter((key) => own[key]).map((key) => [key, own[key]]))} : null;
  return html`<${Card} id="trace-title" title=${file.name}>
      <${Trace} file=${file} mapping=${own.mapping} info=${info} shown=${shown.length ? shown : [0]} marks=${isFriction ? named(marks) : []} range=${own.range ?? null}
        onRange=${(to) => set({range: to}, {replace: true})} onMark=${onMark} />
      ${info.channels.length > 1 && html`<fieldset class="row"><legend class="hidden">Channels</legend>${info.channels.map((each, at) => html`<label key=${each.name} class="check">
        <input type="checkbox" checked=${shown.includes(at)} onChange=${() => show(at)} data-test=${`channel:${each.name}`} /> ${each.name}</label>`)}</fieldset>`}<//>
    <div class="columns"><${Card} id="task-title" title="What is measured">
        <div class="fields"><${Labelled} id="set-task" label="Quantity"><${Select} id="set-task" choices=${Object.entries(TASKS).map(([key, [title]]) => [key, title])} value=${name}
          onChange=${(event) => set({task: event.target.value})} data-test="set:task" /><//>
          ${texts({...TASKS[name][2], ...CONDITIONS})}</div>
        ${isFriction && html`<${Parts} marks=${marks} isFound=${isFound && marks.length > stated.length} enter=${enter} range=${range} />`}<//>
      <${Card} id="measured-title" title="Result" isDim=${isWaiting} data-test="measured">
        ${!asked && html`<p class="hint">Fill in what has a star.</p>`}${isWaiting && html`<${Loading}>Measuring…<//>`}<${Failure} failure=${failure} shown=${Object.keys(own)} />
        ${content && html`<${Blocks} blocks=${content.blocks.slice(1)} />`}<//></div>
    ${content?.charts.filter(({chart}) => chart).map((one) => html`<section class="card" key=${one.name} aria-label=${one.name}><${Chart} ...${one} dimmed=${isWaiting} /></section>`)}
    <${Use} source=${source} />
    ${content && html`<section class="card" aria-label="Caveats"><${Caveats} answer=${content} isMoving=${isWaiting} of=${JSON.stringify(asked)} hasFields=${false} /></section>`}
    <${Columns} file=${file} own=${own} set=${set} info=${info} />`;
}
