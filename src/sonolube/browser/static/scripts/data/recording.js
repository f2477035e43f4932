/**
 * A recording: its channels over time with the parts that are measured, what a task finds in them, and where that goes.
 */
import {html} from '../../vendor/htm-preact-3.1.1.js';
import {short} from '../chart-scale.js';
import {split, TextField} from '../fields.js';
import {Button, Card} from '../parts.js';
import {settle} from '../state.js';
import {Columns} from './columns.js';
import {mappingOf, useMeasured} from './files.js';
import {Choice, Measured, stated} from './measured.js';
import {Trace} from './trace.js';
import {Use} from './use.js';

const NEEDED = 'needed';
/**
 * @import {Asked, DataFile, FileProps, Info, Own, SetOwn} from './files.js'
 * @import {ChangeOptions} from '../state.js'
 * @typedef {{kind: string, from: number, to: number, voltage?: string}} Part of a recording
 * @typedef {Part & {at: number, id: string, label: string, isFixed?: boolean}} NamedPart
 */

/**
 * Tasks: title, channels of which one is needed, and settings with what stands in an empty field.
 * @type {Record<string, [string, RegExp, string[][]]>}
 */
const TASKS = {
  friction: [
    'Friction',
    /^friction_(force|coefficient)$/,
    [
      ['window', 'Window', '2 s'],
      ['rotation_speed', 'Turns of the disc per time', 'found'],
    ],
  ],
  rotation: [
    'Rotation',
    /^magnetic_flux_density$/,
    [
      ['groove_diameter', 'Diameter of the circle under the pin', NEEDED],
      ['magnets', 'Magnets', '1'],
    ],
  ],
  temperature: [
    'Temperature',
    /^temperature$/,
    [
      ['start_time', 'Step of the heat at', 'first sample'],
      ['end_time', 'End of the response', 'last sample'],
    ],
  ],
  calibration: ['Calibration of a force gauge', /^displacement$/, [['degree', 'Degree of the polynomials', '3']]],
  vibration: ['Vibration', /./, [['frequency', 'Frequency of the drive', NEEDED]]],
};
const CONDITIONS = [
  ['sliding_speed', 'Sliding speed'],
  ['normal_load', 'Load'],
  ['voltage_peak_to_peak', 'Voltage, peak to peak'],
  ['vibration_amplitude', 'Amplitude'],
].map((field) => [...field, 'as recorded']);
const PARTS = [
  ['step', 'Add a step'],
  ['rest', 'Add a rest'],
  ['part', 'Measure a part'],
];
const MAX_SHOWN = 3; // channels

/**
 * Task of a recording: the chosen one, else the first that its channels allow.
 * @param {Own} own
 * @param {Partial<Info>} info
 * @returns {string}
 */
const nameOf = (own, {channels = []}) =>
  own.task ?? Object.keys(TASKS).find((name) => channels.some((each) => TASKS[name][1].test(each.name))) ?? '';

/** @param {{from: number, to: number}} part */
const span = ({from, to}) => `${Number(from.toPrecision(9))}s:${Number(to.toPrecision(9))}s`;

/**
 * What measures a recording; null where something is missing that it needs.
 * @param {DataFile} file
 * @param {Own} own
 * @param {Info} info
 * @returns {Asked|null}
 */
export function taskOf(file, own, info) {
  const name = nameOf(own, info);
  const [, , fields] = TASKS[name];
  if (fields.some(([key, , empty]) => empty === NEEDED && !own[key])) return null;
  const given = Object.fromEntries(
    fields.map(([key]) => [key, /^(magnets|degree)$/.test(key) && own[key] ? Number(own[key]) : own[key]]),
  );
  /** @type {Part[]} */
  const marks = own.marks ?? [];
  /** @param {string} kind */
  const of = (kind) => marks.filter((mark) => mark.kind === kind);
  const steps = of('step').map((mark) => [span(mark), mark.voltage]);
  const parts =
    name !== 'friction'
      ? {}
      : {
          sliding_speed: own.sliding_speed,
          part: of('part').map(span)[0],
          ...(of('rest').length && {rest: of('rest').map(span)}),
          ...(steps.length && {step: Object.fromEntries(steps)}),
        };
  return {task: `measure ${name}`, args: stated({files: file, ...mappingOf(own.mapping), ...given, ...parts})};
}

/**
 * Steps that the task has found, as marks.
 * @param {any} content
 * @returns {Part[]}
 */
const foundSteps = (content) =>
  /** @type {any[]} */ (content?.answer.results?.[0]?.tables?.steps?.rows ?? []).map((row) => ({
    kind: 'step',
    from: row.start_time,
    to: row.end_time,
    voltage: `${short(row.voltage_peak_to_peak)} V`,
  }));

/**
 * Marks with their places and names.
 * @param {Part[]} marks
 * @returns {NamedPart[]}
 */
const named = (marks) =>
  marks.map((mark, at) => ({
    ...mark,
    at,
    label: mark.voltage ?? mark.kind,
    id: `${mark.kind}${marks.slice(0, at).filter(({kind}) => kind === mark.kind).length + 1}`,
  }));

/**
 * Parts of a friction recording: a list with voltages, and what adds one within the window that is shown.
 * @param {{marks: Part[], isFound: boolean, enter: (some: Part[]) => void, range: number[]}} props
 */
function Parts({marks, isFound, enter, range: [from, to]}) {
  /** @param {string} kind */
  const add = (kind) => {
    // behind those that are there
    const last = Math.max(from, ...(kind === 'part' || isFound ? [] : marks.map((mark) => mark.to)));
    const begin = last < to ? last : from;
    const mark = {
      kind,
      from: begin,
      to: Math.min(begin + (to - from) / 5, to),
      ...(kind === 'step' && {voltage: '0 V'}),
    };
    enter([...(isFound && kind !== 'step' ? marks.filter((each) => each.kind !== 'step') : marks), mark]);
  };
  /** @param {number} at @param {string} voltage */
  const write = (at, voltage) => enter(marks.map((mark, place) => (place === at ? {...mark, voltage} : mark)));
  return html`<div class="data-parts" role="group" aria-label="Parts">
    ${isFound && html`<p class="hint">Steps as found in the voltage; drag an end to state them.</p>`}
    <ul>
      ${named(marks).map(
        (mark) => html`<li key=${mark.id} class="row">
          <span class=${`tag is-${mark.kind}`}>${mark.kind}</span> ${short(mark.from, 5)} to ${short(mark.to, 5)} s
          ${isFound && mark.voltage && `: ${mark.voltage}`}
          ${
            mark.kind === 'step' &&
            !isFound &&
            html`<${TextField}
              id=${`voltage-${mark.id}`}
              text=${mark.voltage}
              unit="V"
              aria-label=${`Voltage of ${mark.id}`}
              data-test=${`voltage:${mark.id}`}
              onText=${(text, isMoving) => !isMoving && write(mark.at, text)}
              onSettle=${settle}
            />`
          }
          ${
            !(isFound && mark.kind === 'step') &&
            html`<${Button}
              kind="small"
              onClick=${() => enter(marks.filter((_, at) => at !== mark.at))}
              aria-label=${`Remove ${mark.id}`}
            >
              remove
            <//>`
          }
        </li>`,
      )}
    </ul>
    <p class="row">
      ${PARTS.map(
        ([kind, title]) => html`<${Button}
          key=${kind}
          onClick=${() => add(kind)}
          data-test=${`add:${kind}`}
          disabled=${kind === 'part' && marks.some((mark) => mark.kind === kind)}
        >
          ${title}
        <//>`,
      )}
    </p>
  </div>`;
}

/** @param {FileProps} props */
export default function Recording({file, own, set, info, asked}) {
  const {content, failure} = useMeasured(file, asked);
  const columns = html`<${Columns} file=${file} own=${own} set=${set} info=${info} />`;
  if (info.reason) return columns;
  const name = nameOf(own, info);
  const hasParts = name === 'friction' && info.axis.name === 'time';
  /** @type {Part[]} */
  const ownMarks = own.marks ?? [];
  const isFound = hasParts && !ownMarks.some(({kind}) => kind === 'step') && foundSteps(content).length > 0;
  const marks = [...ownMarks, ...(isFound ? foundSteps(content) : [])];
  const window = {
    kind: 'window',
    id: 'window',
    label: 'window',
    isFixed: true,
    from: info.begin,
    to: info.begin + (split(own.window ?? '2 s')?.number ?? 2),
  };
  /** @param {Part[]} some @param {ChangeOptions} [options] */
  const enter = (some, options) => set({marks: some.length ? some : null}, options);
  /** @param {NamedPart} mark @param {string} end @param {number} value @param {boolean} isMoving */
  const onMark = (mark, end, value, isMoving) => {
    if (!isMoving) return settle();
    if (mark.isFixed)
      return set({window: `${Number(Math.max(value - info.begin, 0.01).toPrecision(3))} s`}, {replace: true});
    const others = marks.filter(({kind}, at) => at !== mark.at && kind === mark.kind);
    const least =
      end === 'to' ? mark.from : Math.max(info.begin, ...others.filter(({to}) => to <= mark.to).map(({to}) => to));
    const most =
      end === 'from'
        ? mark.to
        : Math.min(info.end, ...others.filter(({from}) => from >= mark.from).map(({from}) => from));
    return enter(
      marks.map((each, at) => (at === mark.at ? {...each, [end]: Math.min(Math.max(value, least), most)} : each)),
      {replace: true},
    );
  };
  const ofTask = info.channels
    .map((_, at) => at)
    .sort(
      (one, other) =>
        Number(TASKS[name][1].test(info.channels[other].name)) - Number(TASKS[name][1].test(info.channels[one].name)),
    );
  /** @type {number[]} */
  const shown = own.shown?.length ? own.shown : ofTask.slice(0, MAX_SHOWN);
  /** @param {number} at */
  const show = (at) => set({shown: shown.includes(at) ? shown.filter((each) => each !== at) : [...shown, at]});
  const conditions = stated(Object.fromEntries(CONDITIONS.map(([key]) => [key, own[key]])));
  return html`
    <${Card} id="trace-title" title=${file.name}>
      <${Trace}
        file=${file}
        mapping=${own.mapping}
        info=${info}
        shown=${shown}
        marks=${hasParts ? [window, ...named(marks)] : []}
        range=${own.range ?? null}
        onRange=${/** @param {number[]} range */ (range) => set({range})}
        onMark=${onMark}
      />
      ${
        info.channels.length > 1 &&
        html`<fieldset class="row">
          <legend class="hidden">Channels</legend>
          ${info.channels.map(
            (each, at) => html`<label key=${each.name} class="check">
              <input
                type="checkbox"
                checked=${shown.includes(at)}
                onChange=${() => show(at)}
                data-test=${`channel:${each.name}`}
              /> ${each.label}
            </label>`,
          )}
        </fieldset>`
      }
      <${Choice}
        name="task"
        label="What is measured"
        choices=${Object.entries(TASKS).map(([key, [title]]) => [key, title])}
        value=${name}
        onValue=${(task) => set({task})}
      />
      <${Measured} file=${file} asked=${asked} fields=${[...TASKS[name][2], ...CONDITIONS]} own=${own} set=${set}>
        ${
          hasParts &&
          html`<${Parts}
            marks=${marks}
            isFound=${isFound}
            enter=${enter}
            range=${own.range ?? [info.begin, info.end]}
          />`
        }
      <//>
      <${Use} source=${content && !failure ? {results: content.answer.results, conditions} : null} />
    <//>
    ${columns}
  `;
}
