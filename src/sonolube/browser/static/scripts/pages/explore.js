/** Page Explore: a study of the rig over one or two quantities; a click in its figure sets the rig. */
import {html, useEffect, useMemo, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings, Failure, RefusedNote} from '../answer.js';
import {taskPath, useReply} from '../api.js';
import {Chart} from '../chart.js';
import {fieldOf as drawnField} from '../chart-scale.js';
import {Labelled, MaterialChoices, refusedBy, RunsChoice, TextField, typed, uploadOf} from '../fields.js';
import {isActive, JobState, useJob, Waiting} from '../job.js';
import {Button, capital, Card, Refusal, Select, useInView} from '../parts.js';
import {useRig, Workspace} from '../rig-panel.js';
import {useRunsFile} from '../runs-table.js';
import {change, present, settle, useApp} from '../state.js';
import {offer} from '../take-away.js';

/**
 * @import {Fault} from '../api.js'
 * @import {Axis, ChartData, Name, Panel, Part} from '../chart-scale.js'
 * @import {RigField} from '../fields.js'
 * @import {RigView} from '../rig-panel.js'
 * @import {Edits, State, Texts} from '../state.js'
 * @typedef {{title: string, task: string, args?: object, texts?: string[][], isOver?: boolean, isLong?: boolean,
 *   needsStructure?: boolean, kinds?: boolean, runs?: boolean, hasBodies?: boolean}} StudyKind
 */

const ENDS = [
  ['from', 'lowest', 'From'],
  ['to', 'highest', 'To'],
];
/**
 * Studies beside those over one quantity, which the server names: task, entries of the view it takes, what it needs,
 * whether it is a job.
 * @type {Record<string, StudyKind>}
 */
const STUDIES = {
  any: {title: 'Any entry', task: 'sweep', isOver: true, texts: ENDS},
  period: {title: 'One period', task: 'simulate'},
  start: {
    title: 'Start-up',
    task: 'transient',
    texts: [['duration', 'duration', 'Duration']],
    isLong: true,
    needsStructure: true,
  },
  response: {title: 'Impedance', task: 'response', texts: ENDS, needsStructure: true},
  folds: {
    title: 'Folds over frequency',
    task: 'response',
    args: {curve: 'frequency'},
    texts: ENDS,
    needsStructure: true,
  },
  foldsOfVoltage: {
    title: 'Folds over voltage',
    task: 'response',
    args: {curve: 'voltage'},
    needsStructure: true,
    texts: [
      ['from', 'lowest_voltage', 'From'],
      ['to', 'highest_voltage', 'To'],
    ],
  },
  map: {title: 'Map', task: 'map', kinds: true, runs: true},
  heat: {title: 'Temperature', task: 'thermal', texts: [['duration', 'duration', 'Duration']], hasBodies: true},
};
const OVER_POINTS = 41;

/**
 * Names of the studies that a rig has.
 * @param {RigView} rigView
 */
const offeredOf = ({studies, drawing}) => [
  ...studies,
  ...Object.keys(STUDIES).filter((name) => drawing.has_structure || !STUDIES[name].needsStructure),
];

/**
 * Field that the study of any entry runs over, and its values.
 * @param {Texts} view
 * @param {RigField[]} fields
 */
function overOf(view, fields) {
  const numbers = fields.filter((field) => field.lowest != null);
  const field = numbers.find(({key}) => key === view.key) ?? numbers[0];
  /** @param {string|undefined} text @param {number|undefined} number */
  const end = (text, number) => text ?? `${number} ${field.unit}`.trim();
  return field && {numbers, field, from: end(view.from, field.lowest), to: end(view.to, field.highest)};
}

/**
 * Entries set by a click in a map, each as it was set and as the map was drawn with, so that the map stays as it is.
 * @param {State} state
 * @returns {Record<string, [string, string|null]>}
 */
function fixedOf({view, rig}) {
  try {
    const found = view.study === 'map' ? Object.entries(JSON.parse(view.fixed ?? '{}')) : [];
    return Object.fromEntries(found.filter(([key, [set]]) => rig.changes[key] === set));
  } catch {
    return {}; // a link that was cut off
  }
}

/**
 * Rig that a study is of: that of the state, or the one before the clicks in its map.
 * @param {State} state
 */
function rigOf(state) {
  const before = Object.entries(fixedOf(state)).map(([key, [, text]]) => [key, text]);
  return {...state.rig, changes: present({...state.rig.changes, ...Object.fromEntries(before)})};
}

/** One of some names, or else the first of them. @param {string[]} names @param {string} name */
const among = (names, name) => (names.includes(name) ? name : names[0]);

/**
 * Study that the view names, and its arguments.
 * @param {State} state
 * @param {RigView} rigView
 * @returns {{name: string, study: StudyKind, args: Record<string, any>}}
 */
function studyOf(state, rigView) {
  const {view} = state;
  const {fields, maps} = rigView;
  const name = among(offeredOf(rigView), view.study);
  const study = STUDIES[name] ?? {
    title: capital(name),
    task: 'sweep',
    args: {of: name},
    texts: name === 'waveform' ? [] : ENDS,
  };
  const rig = rigOf(state);
  if (study.isOver) {
    const {field, from, to} = overOf(view, fields);
    const {[field.key]: swept, ...changes} = rig.changes; // a change of what is swept would be without effect
    return {name, study, args: {rig: {...rig, changes}, over: {[field.key]: `${from}:${to}:${OVER_POINTS}`}}};
  }
  const texts = argumentsOf(study).filter(([entry]) => view[entry]);
  const args = {
    rig,
    ...study.args,
    ...(study.kinds && view.kind && {kind: among(maps, view.kind)}),
    ...Object.fromEntries(texts.map(([entry, argument]) => [argument, view[entry]])),
    ...(study.runs && view.runs && {runs: uploadOf(view.runs)}),
  };
  return {name, study, args};
}

/**
 * Entries of the view that a study takes, each with the argument of its task.
 * @param {StudyKind} study
 * @returns {string[][]}
 */
const argumentsOf = ({texts = [], hasBodies}) => [
  ...texts,
  ...(hasBodies
    ? [
        ['pin', 'pin'],
        ['disc', 'disc'],
      ]
    : []),
];

/** @param {string} label */
const plain = (label) => label.replaceAll('\n', ' ').toLowerCase();

/**
 * Field of the operating point that an axis shows; undefined where none does.
 * @param {Axis} axis
 * @param {RigField[]} fields
 */
function fieldOf(axis, fields) {
  const label = plain(axis.label ?? '');
  /** @param {RigField} field */
  const named = (field) => label && (label.endsWith(plain(field.label)) || plain(field.label).endsWith(label));
  return fields.find((field) => plain(field.label) === label) ?? fields.filter((field) => field.is_first).find(named);
}

/** @param {Axis} axis */
const unitOf = (axis) => (axis.unit ?? '').replace('µ', 'u'); // as it is typed

/**
 * Number of a field in the unit of an axis, as the server gives it; undefined where there is none.
 * @param {Axis} axis
 * @param {RigField|undefined} field
 */
const numberOn = (axis, field) => field?.numbers[unitOf(axis)];

/**
 * Chart with the operating point of the rig: a rule where only x is of the rig, a point where both axes are.
 * @param {ChartData} chart
 * @param {RigField[]} fields
 * @returns {ChartData}
 */
function withPoint(chart, fields) {
  const panels = chart.panels.map((panel) => {
    const isMap = Boolean(drawnField(panel));
    const x = numberOn(panel.x, fieldOf(panel.x, fields));
    const y = isMap ? numberOn(panel.y, fieldOf(panel.y, fields)) : undefined;
    /** @type {(number|null)[]} */
    const values = panel.parts.find((part) => part.kind === 'field' || part.kind === 'line')?.x ?? [];
    const known = values.filter((value) => value !== null);
    const isThere = x !== undefined && x >= Math.min(...known) && x <= Math.max(...known);
    if (!isThere || panel.parts.some((part) => part.kind === 'rule' && part.along === 'x')) return panel;
    /** @type {Part} */
    const point =
      y === undefined
        ? {kind: 'rule', along: 'x', value: x, label: 'operating point', colour: isMap ? '#d55e00' : '#666666', dash: 3}
        : {kind: 'points', x: [x], y: [y], label: 'operating point', colour: '#d55e00', marker: 3, size: 1.6};
    return {...panel, parts: [...panel.parts, point]};
  });
  return {...chart, panels};
}

/**
 * Choice among names, each with its title, as a row of buttons.
 * @param {{group: string, legend: string, titles: string[][], chosen: string, choose: (partial: Texts) => void}} props
 */
export const Choices = ({
  group,
  legend,
  titles,
  chosen,
  choose,
}) => html`<fieldset class="choices" ref=${useInView(chosen)}>
  <legend>${legend}</legend>
  ${titles.map(
    ([name, title]) => html`<label key=${name} class="choice">
      <input
        type="radio"
        name=${group}
        checked=${name === chosen}
        onChange=${() => choose({[group]: name})}
        data-test=${`${group}:${name}`}
      />
      <span>${title}</span>
    </label>`,
  )}
</fieldset>`;

/**
 * Choice of a study, and of the kind of a map.
 * @param {{name: string, view: Texts, rigView: RigView}} props
 */
function Studies({name, view, rigView}) {
  /** @param {Edits} partial */
  const choose = (partial) => change({view: {from: null, to: null, duration: null, fixed: null, ...partial}});
  return html`
    <${Choices}
      group="study"
      legend="Study"
      chosen=${name}
      choose=${choose}
      titles=${offeredOf(rigView).map((each) => [each, STUDIES[each]?.title ?? capital(each)])}
    />
    ${
      name === 'map' &&
      html`<${Choices}
        group="kind"
        legend="Map over"
        chosen=${among(rigView.maps, view.kind)}
        choose=${choose}
        titles=${rigView.maps.map((each) => [each, each.replaceAll('-', ' and ')])}
      />`
    }
  `;
}

/**
 * Texts that a study takes beside the rig.
 * @param {{study: StudyKind, view: Texts, faults: Fault[], over: any}} props
 */
function StudyTexts({study, view, faults, over}) {
  const fields = study.texts ?? [];
  if (!fields.length) return null;
  /** @param {string} argument */
  const faultOf = (argument) => faults.find((fault) => fault.key === argument)?.text;
  return html`<div class="study-texts">
    ${
      over &&
      html`<${Labelled} id="study-key" label="Entry">
        <${Select}
          id="study-key"
          value=${over.field.key}
          data-test="study-text:key"
          choices=${
            /** @type {RigField[]} */ (over.numbers).map(({key, label}) => [
              key,
              `${label} (${key.slice(0, key.lastIndexOf('.'))})`,
            ])
          }
          onChange=${(event) => change({view: {key: event.target.value, from: null, to: null}})}
        />
      <//>`
    }
    ${fields.map(
      ([
        entry,
        argument,
        label,
      ]) => html`<${Labelled} key=${entry} id=${`study-${entry}`} label=${label} refusal=${faultOf(argument)}>
        <${TextField}
          id=${`study-${entry}`}
          text=${view[entry] ?? ''}
          placeholder=${over?.[entry] ?? 'usual'}
          data-test=${`study-text:${entry}`}
          onText=${(text, isMoving) => !isMoving && change({view: {[entry]: text.trim() || null}})}
          onSettle=${settle}
          ...${refusedBy(`study-${entry}`, faultOf(argument))}
        />
      <//>`,
    )}
    ${study.hasBodies && html`<${MaterialChoices} view=${view} faultOf=${faultOf} />`}
  </div>`;
}

/**
 * Answer of a study: at once, or as a job where it takes long; while the rig moves, that of the last rest.
 * @param {StudyKind} study
 * @param {object} args
 * @param {boolean} isMoving
 */
function useStudy(study, args, isMoving) {
  const rest = useRef(args);
  if (!isMoving) rest.current = args;
  const asked = rest.current;
  const direct = useReply('study', study.isLong ? null : taskPath(study.task), asked);
  const job = useJob(study.isLong ? study.task : null, asked);
  if (study.isLong) {
    return {
      content: job.content,
      failure: job.failure,
      refused: [],
      isWaiting: isActive(job.job) || job.isSought,
      isOld: job.isOld || isMoving,
      job,
      of: asked,
    };
  }
  return {...direct, isOld: isMoving || direct.isWaiting || Boolean(direct.failure), job: null};
}

/**
 * A study: what it takes, its figures, numbers and caveats; made anew for another study.
 * @param {{study: StudyKind, args: Record<string, any>, fields: RigField[], title: string}} props
 */
function Study({study, args, fields, title}) {
  const {state, isMoving} = useApp();
  const {content, failure, refused, isWaiting, isOld, job, of} = useStudy(study, args, isMoving);
  const [note, setNote] = useState('');
  const [runsNote, takeRuns] = useRunsFile();
  const charts = useMemo(
    () => (content ? drawings(content).map((one) => ({...one, chart: withPoint(one.chart, fields)})) : []),
    [content, fields],
  );
  const own = argumentsOf(study).map(([, argument]) => argument);
  const faults = (failure?.faults ?? []).map((fault) => ({
    ...fault,
    key: fault.key || (own.find((argument) => fault.text.startsWith(argument)) ?? ''),
  }));
  return html`
    <${StudyTexts}
      study=${study}
      view=${state.view}
      faults=${faults}
      over=${study.isOver ? overOf(state.view, fields) : undefined}
    />
    ${
      study.runs &&
      html`<div class="study-runs">
        <${RunsChoice} view=${state.view} onFile=${takeRuns} />
        <${Refusal} text=${runsNote} role="alert" />
      </div>`
    }
    ${
      job &&
      html`<div class="row">
        ${
          job.isOld &&
          !isActive(job.job) &&
          !job.isSought &&
          html`
            <${Button}
              kind="button is-main"
              onClick=${() => job.start(`${study.title}: ${title}`)}
              data-test="start-job"
            >
              ${content ? 'Compute again' : 'Compute'}
            <//>
            <span class="hint">${content ? 'The figure is of the rig before.' : 'Takes some seconds.'}</span>
          `
        }
        ${job.job && html`<${JobState} job=${job.job} cancel=${job.cancel} />`}
      </div>`
    }
    <div class="row study-status">
      ${!job && html`<${Waiting} isWaiting=${isWaiting} />`}
      ${note && html`<span role="status" class="status" data-test="picked">${note}</span>`}
      ${
        Object.keys(fixedOf(state)).length > 0 &&
        html`
          <span class="hint">Map and caveats are of the rig before the click.</span>
          <${Button} kind="small" onClick=${() => change({view: {fixed: null}})} data-test="draw-anew">Draw anew<//>
        `
      }
    </div>
    <${Failure} failure=${failure && {...failure, faults}} shown=${[...Object.keys(state.rig.changes), ...own]} />
    <${RefusedNote} refused=${refused} />
    ${!content && !failure && !job && html`<div class="skeleton" aria-hidden="true"></div>`}
    ${
      content &&
      html`<div aria-busy=${isWaiting} data-test="study">
        ${charts.map(
          (one) => html`<${Chart}
            key=${one.name}
            ...${one}
            dimmed=${isOld}
            onPick=${(at) => setNote(pick(at, one.chart, fields, state))}
            canPick=${(panel) => Boolean(pickedOf(one.chart.panels[panel], fields).length)}
          />`,
        )}
        <div class="columns">
          <div class="stack">
            <${Card} id="study-numbers" title="Result" isDim=${isOld}><${Blocks} blocks=${content.blocks} /><//>
          </div>
          <div class="stack">
            <${Card} id="study-caveats" title="Caveats and assumptions" isTitleHidden=${true}>
              <${Caveats} answer=${content} isMoving=${isMoving || isWaiting} of=${JSON.stringify(of)} />
            <//>
          </div>
        </div>
      </div>`
    }
  `;
}

export default function Explore() {
  const {state} = useApp();
  const {view: rigView} = useRig();
  const fields = rigView?.fields ?? [];
  const asked = rigView && studyOf(state, rigView);
  useEffect(() => (asked ? offer(asked.study.task, asked.args) : undefined), [JSON.stringify(asked?.args)]);
  const lead = html`
    <p class="overline">Explore</p>
    <h1 class="statement">Choose an operating point</h1>
    ${asked && html`<${Studies} name=${asked.name} view=${state.view} rigView=${rigView} />`}
  `;
  return html`<${Workspace} lead=${lead}>
    ${
      asked &&
      html`<${Study}
        key=${[asked.name, asked.args.kind, state.view.key, state.rig.name].join(' ')}
        study=${asked.study}
        args=${asked.args}
        fields=${fields}
        title=${rigView.title}
      />`
    }
  <//>`;
}

/**
 * Axes of a panel that are of the rig: those of x, and of y where a field lies over both.
 * @param {Panel} panel
 * @param {RigField[]} fields
 * @returns {[Name, RigField][]}
 */
function pickedOf(panel, fields) {
  /** @type {Name[]} */
  const names = drawnField(panel) ? ['x', 'y'] : ['x'];
  return names.flatMap((name) => {
    const field = fieldOf(panel[name], fields);
    return field ? [/** @type {[Name, RigField]} */ ([name, field])] : [];
  });
}

/**
 * Set the rig to a place of a panel; returns what is said of it.
 * @param {{panel: number, x: number, y: number}} at
 * @param {ChartData} chart
 * @param {RigField[]} fields
 * @param {State} state
 */
function pick(at, chart, fields, state) {
  const panel = chart.panels[at.panel];
  const found = pickedOf(panel, fields).map(([name, field]) => ({field, text: typed(at[name], unitOf(panel[name]))}));
  if (!found.length) return '';
  const {rig} = state;
  const drawn = rigOf(state).changes;
  const isMap = Boolean(drawnField(panel));
  const fixed = {
    ...fixedOf(state),
    ...Object.fromEntries(found.map(({field, text}) => [field.key, [text, drawn[field.key] ?? null]])),
  };
  const changes = {...rig.changes, ...Object.fromEntries(found.map(({field, text}) => [field.key, text]))};
  change({rig: {...rig, changes}, ...(isMap && {view: {fixed: JSON.stringify(fixed)}})});
  return `Set ${found.map(({field, text}) => `${field.label} to ${text}`).join(' and ')}.`;
}
