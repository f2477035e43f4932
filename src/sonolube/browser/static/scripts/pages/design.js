/**
 * Page Design: designs for a target friction, a plan of the next tests, and a friction controller, each to take away.
 */
import {html, useEffect} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings, Failure, RefusedNote, TextTable} from '../answer.js';
import {taskPath, useLate, useReply} from '../api.js';
import {Chart} from '../chart.js';
import {Fields, given, Ranges, useSchema, withNames} from '../design/asked.js';
import {JobFiles, Saves} from '../design/files.js';
import {Front} from '../design/front.js';
import {MaterialChoices, RunsChoice, uploadOf} from '../fields.js';
import {isActive, JobState, useJob, Waiting} from '../job.js';
import {Button, Card, classes, Loading, Refusal} from '../parts.js';
import {useRig, Workspace} from '../rig-panel.js';
import {useRunsFile} from '../runs-table.js';
import {change, present, useApp} from '../state.js';
import {offer} from '../take-away.js';
import {Choices} from './explore.js';

/**
 * @import {Content} from '../answer.js'
 * @import {Answer} from '../api.js'
 * @import {Schemas} from '../design/asked.js'
 * @import {RigView} from '../rig-panel.js'
 * @import {RigState, State, Texts} from '../state.js'
 * @typedef {{state: State, rigView: RigView, schema: Schemas, note: string, takeRuns: (file: File) => void}} PartProps
 * @typedef {Answer & {isWaiting: boolean, isDim: boolean, faultOf: (name: string) => string|undefined}} AtOnce
 */

const TARGET = ['target_friction', 'target_reduction', 'minimise', 'pareto', 'actuator'];
const LIMITS = [
  'voltage_limit',
  'current_limit',
  'slew_limit',
  'stress_limit',
  'temperature_limit',
  'conductance',
  'horn',
  'horn_limit',
  'bolt',
  'preload',
  'bolt_strength',
  'robust',
  'quantile',
  'quality',
  'source_resistance',
  'samples',
];
const PLANNED = ['speed', 'load', 'vibration', 'voltage', 'points', 'difference'];
const QUESTION = [
  'power',
  'significance',
  'comparison',
  'scatter',
  'block',
  'running_in',
  'measuring_time',
  'amplifier_voltage',
  'amplifier_power',
  'temperature_rise',
  'seed',
];
const BESIDE = ['pin', 'disc', 'runs']; // arguments that other pages have too
const LOOP = ['friction', 'rate', 'delay', 'closed_loop', 'disturbance', 'factor'];
const DEVICE = [
  'feed_forward',
  'efficiency',
  'voltage_limit',
  'amplitude_limit',
  'current_limit',
  'slew_limit',
  'noise',
  'warming',
  'warming_time',
  'duration',
  'quality',
  'coupling',
  'track',
  'stick_slip',
];
// arguments that a controller and its units share
const OF_UNITS = ['delay', 'rate', 'closed_loop', 'track', 'quality', 'coupling'];
const LABELS = {
  pareto: 'Second objective',
  actuator: 'Actuators',
  robust: 'Tolerance',
  friction: 'Target friction',
  rate: 'Sampling rate',
  delay: 'Dead time',
  closed_loop: 'Closed-loop time',
  factor: 'Real friction',
  track: 'Track the resonance',
  fmi: 'FMI version',
  block: 'Blocks',
};

/**
 * Text of a row of the facts of an answer.
 * @param {Content} content
 * @param {string} name
 */
const factOf = ({blocks}, name) =>
  blocks
    .find(({kind}) => kind === 'rows')
    ?.rows?.find(([label]) => label === name)?.[1]
    .replace(/ \(D .*\)/, '');

/**
 * What an answer says, above its numbers.
 * @param {{text: string, isDim: boolean}} props
 */
const Statement = ({text, isDim}) =>
  html`<p class=${classes('statement', {'is-dim': isDim})} aria-live="polite" data-test="statement">${text}</p>`;

/**
 * Form of a part: first fields, and further ones folded, opened where one of them is refused.
 * @param {{label: string, first: string[], more: string[], moreTitle: string, children?: any, [name: string]: any}}
 *   props further ones are of its fields
 */
const Form = ({
  label,
  first,
  more,
  moreTitle,
  children,
  ...rest
}) => html`<form class="card" aria-label=${label} onSubmit=${(event) => event.preventDefault()}>
  <${Fields} names=${first} labels=${LABELS} ...${rest} />
  ${children}
  <details open=${more.some(rest.faultOf) || undefined}>
    <summary>${moreTitle}</summary>
    <${Fields} names=${more} labels=${LABELS} ...${rest} />
  </details>
</form>`;

/**
 * Charts of an answer but one that stands elsewhere, its facts and caveats.
 * @param {{content: Content, isDim: boolean, of: string, without?: string}} props
 */
const Results = ({content, isDim, of, without}) => html`
  ${drawings(content)
    .filter(({name}) => name !== without)
    .map(
      (one) => html`<section class="card" key=${one.name} aria-label=${one.caption}>
        <${Chart} ...${one} dimmed=${isDim} />
      </section>`,
    )}
  <div class="columns">
    <div class="stack">
      <${Card} id="facts" title="Result" isDim=${isDim}>
        <${Blocks} blocks=${content.blocks.filter(({kind}) => kind !== 'table')} />
      <//>
    </div>
    <div class="stack">
      <${Card} id="caveats" title="Caveats and assumptions" isTitleHidden=${true}>
        <${Caveats} answer=${content} isMoving=${isDim} of=${of} />
      <//>
    </div>
  </div>
`;

/**
 * Designs for a target friction or reduction: a job, its front linked with its table.
 * @param {PartProps} props
 */
function Designs({state: {view, rig}, rigView, schema}) {
  const names = [...TARGET, ...LIMITS, 'over'];
  const over = Object.fromEntries(rigView.fields.map(({key}) => [key, view[`over.${key}`]]).filter(([, text]) => text));
  // what varies has no value of its own
  const changes = Object.fromEntries(Object.entries(rig.changes).filter(([key]) => !(key in over)));
  /** @type {Record<string, any>} */
  const args = {
    rig: {...rig, changes},
    ...given('optimise', [...TARGET, ...LIMITS], schema, view),
    ...(Object.keys(over).length && {over}),
  };
  const isAsked = Boolean(args.target_friction ?? args.target_reduction);
  const {job, content, start, cancel, ...found} = useJob(isAsked ? 'optimise' : null, args);
  const isOld = found.isOld || !isAsked;
  const reason = job?.state === 'refused' && job.reason;
  const failure = withNames(
    reason ? {kind: 'refused', text: reason, faults: [{key: '', text: reason}]} : found.failure,
    names,
  );
  /** @param {string} name */
  const faultOf = (name) => failure?.faults.find(({key}) => key === name)?.text;
  useEffect(() => (isAsked ? offer('optimise', args) : undefined), [JSON.stringify(args)]);
  const ending = content?.answer.front.length ? '-front' : '-frequency';
  const linked = content && drawings(content).find(({name}) => name.endsWith(ending));
  const hint = !isAsked
    ? 'Give a target friction or a reduction.'
    : content
      ? 'The designs are of the rig or the target before.'
      : 'Takes seconds to minutes.';
  return html`
    <${Form}
      label="Target, limits, what may vary"
      first=${TARGET}
      more=${LIMITS}
      moreTitle="Limits and tolerances"
      prefix="optimise"
      schema=${schema}
      view=${view}
      faultOf=${faultOf}
    >
      <${Ranges} fields=${rigView.fields} view=${view} fault=${faultOf('over')} />
    <//>
    <div class="row design-run">
      ${
        isOld &&
        !isActive(job) &&
        !found.isSought &&
        html`
          <${Button}
            kind="button is-main"
            disabled=${!isAsked}
            onClick=${() => start(`Designs: ${rigView.title}`)}
            data-test="start-job"
          >
            ${content ? 'Search again' : 'Search'}
          <//>
          <span class="hint">${hint}</span>
        `
      }
      ${job && job.state !== 'refused' && html`<${JobState} job=${job} cancel=${cancel} />`}
    </div>
    <${Failure} failure=${failure} shown=${names} />
    ${
      content &&
      html`<div class="parts" data-test="designs">
        <${Statement}
          isDim=${isOld}
          text=${[
            `Least ${content.answer.minimise}: ${factOf(content, 'power to supply')}`,
            `at ${factOf(content, 'drive')}`,
          ].join(' ')}
        />
        <${Front} content=${content} linked=${linked} isDim=${isOld} rig=${rig} />
        <${Results} content=${content} isDim=${isOld} of=${JSON.stringify(args)} without=${linked?.name} />
        <${JobFiles} job=${job} files=${content.files} />
      </div>`
    }
  `;
}

/**
 * Answer of a task to the fields of a part, at once; refusals by their field.
 * @param {string} task
 * @param {object} args
 * @param {string[]} names
 * @returns {AtOnce}
 */
function useAnswer(task, args, names) {
  const reply = useReply('design', taskPath(task), args);
  const failure = withNames(reply.failure, names);
  useEffect(() => offer(task, args), [JSON.stringify(args)]);
  const isDim = useLate(reply.isWaiting || Boolean(failure));
  /** @param {string} name */
  const faultOf = (name) => failure?.faults.find(({key}) => key === name)?.text;
  return {...reply, failure, isDim, faultOf};
}

/**
 * What stands above the numbers of an answer: waiting, refused, left out.
 * @param {{reply: AtOnce, names: string[], rig: RigState}} props
 */
const Status = ({reply, names, rig}) => html`
  <div class="row study-status"><${Waiting} isWaiting=${reply.isWaiting} /></div>
  <${Failure} failure=${reply.failure} shown=${[...names, ...Object.keys(rig.changes)]} />
  <${RefusedNote} refused=${reply.refused} />
  ${!reply.content && !reply.failure && html`<div class="skeleton" aria-hidden="true"></div>`}
`;

/** @param {boolean[]} states */
const statesText = (states) => states.map((is) => (is ? 'on' : 'off')).join(', ');

/**
 * Plan of the next tests, its sheet, its table to fill and the protocols of its runs.
 * @param {PartProps} props
 */
function Plan({state: {view, rig}, schema, note, takeRuns}) {
  const names = [...PLANNED, ...QUESTION, ...BESIDE];
  const args = present({
    rig,
    ...given('plan', [...PLANNED, ...QUESTION], schema, view),
    pin: view.pin,
    disc: view.disc,
    runs: view.runs && uploadOf(view.runs),
  });
  const reply = useAnswer('plan', args, names);
  const {content, isDim, faultOf} = reply;
  /** @type {import('../answer.js').Block[]} */
  const blocks = content?.blocks ?? [];
  const points = blocks.find(({kind}) => kind === 'table');
  /** @type {{run: number, block: number, point: number, specimens: string[], vibrated: boolean[][]}[]} */
  const runs = content?.answer.runs ?? [];
  return html`
    <${Form}
      label="What to test"
      first=${PLANNED}
      more=${QUESTION}
      moreTitle="Question, procedure and limits"
      prefix="plan"
      schema=${schema}
      view=${view}
      faultOf=${faultOf}
    >
      <div class="fields two"><${MaterialChoices} view=${view} faultOf=${faultOf} /></div>
      <${RunsChoice} view=${view} onFile=${takeRuns} />
      <${Refusal} text=${note || faultOf('runs')} role="alert" />
    <//>
    <${Status} reply=${reply} names=${names} rig=${rig} />
    ${
      content &&
      html`<div class="parts" aria-busy=${reply.isWaiting} data-test="plan">
        <${Statement} isDim=${isDim} text=${content.blocks[0].text.replace(/^.*: (?=\d+ points)/s, '')} />
        <${Saves}
          task="plan"
          args=${args}
          isOff=${isDim}
          files=${[
            ['Sheet to print (HTML)', 'report'],
            ['Table of the runs (CSV)', '-runs.csv'],
            ['Table and protocols (ZIP)', 'all'],
          ]}
        />
        <${Card} id="plan-points" title="Points" isDim=${isDim}>
          <${TextTable} ...${points} kind="table-frame" test="plan-points" />
        <//>
        <${Results} content=${content} isDim=${isDim} of=${JSON.stringify(args)} />
        <${Card} id="plan-runs" title="Runs in their order" isDim=${isDim}>
          <${TextTable}
            heads=${['run', 'block', 'point', 'specimens', 'vibration']}
            test="plan-runs"
            rows=${runs.map((run) => [
              run.run,
              run.block,
              run.point,
              run.specimens.join(', '),
              run.vibrated.map(statesText).join('; '),
            ])}
          />
        <//>
      </div>`
    }
  `;
}

/**
 * Units of the Functional Mock-up Interface, as a job with its files.
 * @param {{args: Record<string, any>, view: Texts, title: string}} props
 */
function Units({args, view, title}) {
  const {schema} = useSchema('export fmu');
  const shared = Object.fromEntries(OF_UNITS.map((name) => [name, args[name]]));
  const asked = present({
    rig: args.rig,
    ...shared,
    ...(schema && given('fmu', ['fmi'], schema, view)),
    pin: view.pin,
    disc: view.disc,
  });
  const {job, content, isOld, isSought, failure, start, cancel} = useJob(schema ? 'export fmu' : null, asked);
  return (
    schema &&
    html`<${Card} id="units" title="Plant and controller as units (FMU)">
      <div class="fields two">
        <${Fields}
          names=${['fmi']}
          prefix="fmu"
          schema=${schema}
          labels=${LABELS}
          view=${view}
          faultOf=${() => undefined}
        />
        <${MaterialChoices} view=${view} faultOf=${() => undefined} />
      </div>
      <div class="row">
        ${
          isOld &&
          !isActive(job) &&
          !isSought &&
          html`
            <${Button} kind="button is-main" onClick=${() => start(`Units: ${title}`)} data-test="start-job">
              Make the units
            <//>
            <span class="hint">Takes some seconds; materials of both bodies give the plant a temperature.</span>
          `
        }
        ${job && html`<${JobState} job=${job} cancel=${cancel} />`}
      </div>
      <${Failure} failure=${failure} />
      ${
        content &&
        !isOld &&
        html`<${JobFiles} job=${job} files=${content.files} /><${Caveats} answer=${content} isMoving=${false} of="" />`
      }
    <//>`
  );
}

/**
 * A friction controller: its margins and responses, its C source, table and units.
 * @param {PartProps} props
 */
function Control({state: {view, rig}, schema, rigView}) {
  const names = [...LOOP, ...DEVICE];
  const args = {rig, ...given('control', names, schema, view)};
  const reply = useAnswer('control', args, names);
  const {content, isDim, faultOf} = reply;
  /** @type {{key: string, label: string, text: string}[]} */
  const summary = content?.answer.summary ?? [];
  const margins = ['gain_margin', 'phase_margin'].map((name) => summary.find(({key}) => key === name)?.text);
  return html`
    <${Form}
      label="Loop"
      first=${LOOP}
      more=${DEVICE}
      moreTitle="Device, limits and run"
      prefix="control"
      schema=${schema}
      view=${view}
      faultOf=${faultOf}
    />
    <${Status} reply=${reply} names=${names} rig=${rig} />
    ${
      content &&
      html`<div class="parts" aria-busy=${reply.isWaiting} data-test="control">
        <${Statement} isDim=${isDim} text=${`Gain margin ${margins[0]}, phase margin ${margins[1]}`} />
        <dl class="numbers" data-test="numbers">
          ${summary.map(
            ({key, label, text}) =>
              html`<div key=${key} class="number"><dt>${label}</dt><dd class="median">${text}</dd></div>`,
          )}
        </dl>
        <${Saves}
          task="control"
          args=${args}
          isOff=${isDim}
          files=${[
            ['Controller in C', '.c'],
            ['Its table (CSV)', '.csv'],
            ['Run (netCDF)', '.nc'],
            ['All (ZIP)', 'all'],
          ]}
        />
        <${Units} args=${args} view=${view} title=${rigView.title} />
        <${Results} content=${content} isDim=${isDim} of=${JSON.stringify(args)} />
      </div>`
    }
  `;
}

/**
 * Parts of the page: name of the choice, title, task, component.
 * @type {Record<string, [string, string, string, any]>}
 */
const PARTS = {
  designs: ['Designs for a target', 'Which design reaches a friction', 'optimise', Designs],
  plan: ['Test plan', 'Which tests tell the models apart', 'plan', Plan],
  control: ['Controller', 'How well friction is held', 'control', Control],
};

export default function Design() {
  const {state} = useApp();
  const {view: rigView, failure} = useRig();
  const [note, takeRuns] = useRunsFile();
  const part = Object.hasOwn(PARTS, state.view.part) ? state.view.part : 'designs';
  const [, title, task, Part] = PARTS[part];
  const described = useSchema(task);
  const fault = failure ?? described.failure;
  const lead = html`
    <p class="overline">Design and control</p>
    <h1 class="statement">${title}</h1>
    <${Choices}
      group="part"
      legend="What for"
      chosen=${part}
      titles=${Object.entries(PARTS).map(([name, [short]]) => [name, short])}
      choose=${(partial) => change({view: partial})}
    />
  `;
  return html`<${Workspace} lead=${lead} onFile=${takeRuns}>
    ${
      rigView && described.schema
        ? html`<${Part}
          key=${`${part} ${state.rig.name}`}
          ...${{state, rigView, note, takeRuns, schema: described.schema}}
        />`
        : html`<${Failure} failure=${fault} />${!fault && html`<${Loading}>Reading…<//>`}`
    }
  <//>`;
}
