/** Page Predict: how much friction and wear fall on the rig, how sure that is, and what would sharpen it. */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Caveats, Failure, RefusedNote, TextTable} from '../answer.js';
import {ask, callTask, inTurn, useLate, useReply} from '../api.js';
import {Bar, ChangeBars} from '../change-bars.js';
import {Chart} from '../chart.js';
import {focusField, MaterialChoices, RunsChoice, typed, uploadOf} from '../fields.js';
import {Button, Card, classes, Refusal, words} from '../parts.js';
import {useRig, Workspace} from '../rig-panel.js';
import {RunsTable, useRunsFile} from '../runs-table.js';
import {addressOf, change, decode, encode, present, setEntry, useApp} from '../state.js';
import {offer} from '../take-away.js';

/**
 * @import {Block, Content} from '../answer.js'
 * @import {ChartData} from '../chart-scale.js'
 * @import {RigView} from '../rig-panel.js'
 * @import {State, Texts} from '../state.js'
 * @typedef {{label: string, answer: Content}} KeptAnswer
 * @typedef {{kind: 'table', heads: string[], rows: string[][]}} TableBlock
 */

const MOVING_DRAWS = 1000;
const MAX_KEPT = 3;
const INTERVAL = '80 %';
const SPEED = 'sliding.sliding_speed';
const AMPLITUDE = 'vibration.vibration_amplitude';
const VOLTAGE = 'drive.voltage_peak_to_peak';
/** Fields that a measurement is about, by its key. @type {Record<string, string[]>} */
const ADVISED = {
  contact_stiffness: ['contact.decay_length', 'contact.normal_stiffness', 'contact.pair.effective_modulus'],
  run_at_other_speed: [SPEED],
  run_here: ['runs'],
};

/**
 * Arguments of the task for a state.
 * @param {State} state
 * @param {boolean} isMoving
 */
function argumentsOf(state, isMoving) {
  const {pin, disc, lubricant, runs} = state.view;
  return present({
    rig: state.rig,
    runs: runs && uploadOf(runs),
    pin,
    disc,
    lubricant: lubricant ? true : null,
    draws: isMoving ? MOVING_DRAWS : null,
  });
}

/** Tables of an answer. @param {Content} answer @returns {TableBlock[]} */
const tablesOf = ({blocks}) =>
  blocks.flatMap(({kind, heads = [], rows = []}) => (kind === 'table' ? [{kind, heads, rows}] : []));

/**
 * Numbers of an answer by their labels, each as its median and interval: quantities, then the operating point.
 * @param {Content} answer
 * @returns {{quantities: Map<string, string[]>, point: Map<string, string[]>}}
 */
function numbersOf(answer) {
  const [{heads, rows}] = tablesOf(answer);
  const at = heads.indexOf(INTERVAL);
  /** @type {{label: string, text: string}[]} */
  const point = answer.answer.operating_point ?? [];
  return {
    quantities: new Map(rows.map((row) => [row[0], [row[1], row[at]]])),
    point: new Map(point.map(({label, text}) => [label, text.split(/ (?=within )/)])),
  };
}

/**
 * Changes of friction and wear as bars, and the power to supply.
 * @param {{answer: Content}} props
 */
function Changes({answer}) {
  const {friction_reduction: friction, wear_reduction: wear, friction_coefficient: coefficient} = answer.answer;
  /** @type {{name: string, text: string}[]} */
  const powers = answer.answer.operating_point;
  const power = powers.find(({name}) => name === 'power_to_supply')?.text ?? 'not known';
  const charge = powers.find(({name}) => name === 'charging_power')?.text;
  return html`
    <${ChangeBars}
      test="changes"
      rows=${[
        {name: 'Friction', change: friction, note: coefficient && `coefficient ${coefficient.median.toPrecision(2)}`},
        {name: 'Wear', change: wear, note: wear?.interval_80[0] < 0 ? 'may not fall' : '', text: 'not known'},
        {name: 'Power to supply', text: charge ? `${power}; ${charge} charge the capacitance` : power},
      ]}
    />
  `;
}

/**
 * All numbers on request.
 * @param {{answer: Content}} props
 */
function Numbers({answer}) {
  const {quantities, point} = numbersOf(answer);
  return html`
    <details class="numbers-of-all">
      <summary>All numbers</summary>
      <dl class="numbers" data-test="numbers">
        ${[...quantities, ...point].map(
          ([label, [median, interval]]) => html`<div key=${label} class="number">
            <dt>${label}</dt>
            <dd class="median">${median}</dd>
            ${interval && html`<dd class="interval">${interval}</dd>`}
          </div>`,
        )}
      </dl>
      <p class="hint numbers-note">Median, and below it the interval of ${INTERVAL}.</p>
    </details>
  `;
}

/**
 * Interval of friction as it is, and as one run of the user's own would leave it.
 * @param {{answer: Content, beside: Texts}} props
 */
function Surer({answer, beside}) {
  const {friction_reduction: now, one_run: after} = answer.answer;
  if (!after) return null;
  return html`<${Card} id="surer-title" title="Make it surer" data-test="surer">
    <div class="surer">
      <div>
        <${Bar} change=${now} label="now" />
        <${Bar} change=${after.friction_reduction} label="after one run of yours" />
      </div>
      <p>One run of yours here: ${after.text}.</p>
      <div class="row">
        <${Button}
          kind="button is-main"
          onClick=${() => document.getElementById('own-runs')?.focus()}
          data-test="add-runs"
        >
          Add my runs
        <//>
        <a class="button" href=${addressOf('design', present({part: 'plan', ...beside}))} data-test="plan-runs">Plan</a>
      </div>
    </div>
  <//>`;
}

/**
 * What would narrow the interval, most first; a click opens what it is about.
 * @param {{answer: Content, beside: Texts}} props
 */
function Sharpen({answer, beside}) {
  const tables = tablesOf(answer);
  /** @type {string[]} */
  const probes = answer.answer.stiffness_probes ?? [];
  /** @type {{key: string, label: string, share_left: number}[]} */
  const measurements = answer.answer.measurements;
  if (!measurements.length) return null;
  return html`<${Card} id="sharpen-title" title="What would sharpen this" data-test="sharpen">
    <ul class="measures">
      ${measurements.map(({key, label, share_left: left}) => {
        const keys = ADVISED[key] ?? [];
        const open = () => (keys[0] === 'runs' ? document.getElementById('own-runs')?.focus() : keys.some(focusField));
        const narrower = `${Math.round(100 * (1 - left))} %`;
        return html`<li key=${label}>
          <${Button} kind="measure" onClick=${open} disabled=${!keys.length}>
            <span class="measure-name">${label}</span>
            <span class="measure-share">
              <meter min="0" max="1" value=${1 - left} aria-label=${`narrower by ${narrower}`}></meter>
              ${narrower} narrower
            </span>
          <//>
        </li>`;
      })}
    </ul>
    <p class="hint">
      How much narrower each would make the interval of friction. <a
        href=${addressOf('design', present({part: 'plan', ...beside}))}
        data-test="plan-tests"
      >
        Plan these tests
      </a>
    </p>
    <details>
      <summary>Least known inputs</summary>
      <${TextTable} ...${tables.at(-1)} kind="table-frame" />
      ${probes.map((line) => html`<p key=${line} class="hint">${line}</p>`)}
    </details>
  <//>`;
}

/**
 * Files of own runs: dropped anywhere on the page, or chosen.
 * @param {{view: Texts, onFile: (file: File) => void, note: string, disagreeing?: number[]}} props
 */
function OwnRuns({view, onFile, note, disagreeing}) {
  const [help, setHelp] = useState('');
  const read = async () => {
    const {content, failure} = await ask('api/description');
    const schema = content?.paths['/api/tasks/predict'].post.requestBody.content['application/json'].schema;
    setHelp(schema?.properties.runs.description ?? failure?.text);
  };
  return html`<${Card} id="runs-title" title="Own runs" data-test="own-runs">
    <${RunsChoice} view=${view} onFile=${onFile} />
    <p class="hint">Or drop a file of runs on this page.</p>
    <${Refusal} text=${note} role="alert" />
    <${RunsTable} view=${view} disagreeing=${disagreeing} />
    <details onToggle=${read}>
      <summary>What the file holds</summary>
      <p class="hint">${help || 'Reading…'}</p>
    </details>
  <//>`;
}

/**
 * Materials and lubrication, which the task takes beside the rig.
 * @param {{view: Texts, faultOf: (name: string) => string|undefined, isFirst: boolean}} props
 */
const Materials = ({view, faultOf, isFirst}) => html`<fieldset class="fields materials">
  <legend>For wear and heat</legend>
  <${MaterialChoices} view=${view} faultOf=${faultOf} isAsked=${!isFirst} />
  <label class="check">
    <input
      type="checkbox"
      checked=${Boolean(view.lubricant)}
      data-test="lubricant"
      onChange=${(event) => change({view: {lubricant: event.target.checked ? 'yes' : null}})}
    /> The contact is lubricated
  </label>
  <${Refusal} text=${faultOf('lubricant')} />
</fieldset>`;

/**
 * Answers that were kept, beside the answer of now.
 * @param {{kept: (KeptAnswer & {id: string})[], now: Content, onRemove: (id: string) => void}} props
 */
function Kept({kept, now, onRemove}) {
  if (!kept.length) return null;
  const current = numbersOf(now);
  const found = [...kept.map((one) => numbersOf(one.answer)), current];
  const {quantities, point} = current;
  const rows = [
    ...[...quantities.keys()].map((name) => [
      name,
      ...found.map((each) => each.quantities.get(name)).map((of) => (of ? `${of[0]} (${of[1]})` : '–')),
    ]),
    ...[...point.keys()].map((label) => [label, ...found.map((each) => each.point.get(label)?.join(' ') ?? '–')]),
  ];
  return html`<${Card} id="kept-title" title="Kept answers" data-test="kept">
    <ul class="kept-list">
      ${kept.map(
        (one, place) => html`<li key=${one.id}>
          <span class=${`swatch is-${place}`}></span>
          <span class="grow">${one.label}</span>
          <${Button} kind="small" onClick=${() => onRemove(one.id)} aria-label=${`Remove ${one.label}`}>remove<//>
        </li>`,
      )}
    </ul>
    <${TextTable} heads=${['', ...kept.map((one) => one.label), 'now']} rows=${rows} test="differences" />
    <p class="hint">Median, and the interval of ${INTERVAL}.</p>
  <//>`;
}

/** Answers that were kept, by the fragment of their state. @type {Map<string, KeptAnswer>} */
const keptAnswers = new Map();

/**
 * Name of a kept state: its changes, else its rig.
 * @param {State} state
 */
function labelOf(state) {
  const texts = Object.values(state.rig.changes);
  return texts.length ? texts.slice(0, 3).join(', ') + (texts.length > 3 ? '…' : '') : state.rig.name;
}

/**
 * States that the view keeps, with their answers; those that are not known yet are asked for.
 * @param {State} state
 * @param {any} content
 */
function useKept(state, content) {
  const [, draw] = useState({});
  const fragments = (state.view.kept ?? '').split('\n').filter(Boolean);
  useEffect(() => {
    fragments
      .filter((each) => !keptAnswers.has(each))
      .forEach(async (fragment) => {
        const of = await decode(fragment);
        const reply = await inTurn(fragment, () => callTask('predict', argumentsOf(of, false)));
        if (reply?.content) keptAnswers.set(fragment, {label: labelOf(of), answer: reply.content});
        draw({});
      });
  }, [state.view.kept]);
  /** @param {string[]} some */
  const enter = (some) => change({view: {kept: some.join('\n') || null}});
  const keep = () => {
    const fragment = encode({...state, view: present({...state.view, kept: null})});
    keptAnswers.set(fragment, {label: labelOf(state), answer: content});
    enter([...fragments.filter((each) => each !== fragment), fragment].slice(-MAX_KEPT));
  };
  const kept = fragments.flatMap((each) => {
    const answer = keptAnswers.get(each);
    return answer ? [{id: each, ...answer}] : [];
  });
  /** @param {string} fragment */
  const remove = (fragment) => enter(fragments.filter((each) => each !== fragment));
  return {kept, keep, remove};
}

/**
 * What dragging the rule of a panel sets, where a number follows from it without computing.
 * @param {RigView|null} view
 * @param {ChartData} chart
 */
function dragOf(view, chart) {
  const keys = new Set(view?.fields.map((field) => field.key));
  return [AMPLITUDE, SPEED].flatMap((key, panel) => {
    if (!keys.has(key) || (key === AMPLITUDE && keys.has(VOLTAGE))) return [];
    const unit = chart.panels[panel]?.x.unit?.replace('µ', 'u') ?? '';
    /** @param {number} x @param {boolean} isMoving */
    const set = (x, isMoving) => setEntry(key, typed(x, unit), {replace: isMoving});
    return [
      {
        panel,
        /** @param {number} x */
        onMove: (x) => set(x, true),
        /** @param {number} x */
        onRelease: (x) => set(x, false),
      },
    ];
  });
}

/**
 * What is said of a rig that cannot be predicted: the friction by its own model, and why there is no interval.
 * @param {{answer: Content, reason: string}} props
 */
function ByModel({answer, reason}) {
  const rows = answer.blocks.flatMap((block) => block.rows ?? []).filter(([, text]) => !words(text).includes(reason));
  return html`<div class="first-screen" data-test="by-model">
    <${Card} id="model-title" kind="card is-figure" title="What its model says">
      <${TextTable} rows=${rows} label="Friction by the model of the rig" />
      <p class="hint">
        One value, without an interval.${' '}
        <a href=${addressOf('explore')} data-test="explore-model">See it over amplitude, speed and load</a>
      </p>
    <//>
    <section class="card" aria-label="Caveats and assumptions">
      <${Caveats} answer=${answer} isMoving=${false} of="" />
    </section>
  </div>`;
}

/**
 * Why a rig has no prediction, without its title and without what the terminal offers instead.
 * @param {string} text
 */
const reasonOf = (text) => words(text.slice(text.indexOf(': ') + 2).split('; use sonolube ')[0]);

/**
 * Whether a refusal is of no single entry, as that of a rig that cannot be predicted is.
 * @param {import('../api.js').Failure|null} failure
 */
const isOfRig = (failure) => failure?.kind === 'refused' && failure.faults.every(({key}) => !key);

export default function Predict() {
  const {state, isMoving} = useApp();
  const {view} = useRig();
  const [note, onFile] = useRunsFile();
  const {pin, disc, runs} = state.view;
  const body = argumentsOf(state, isMoving);
  const reply = useReply('predict', state.rig.name ? `api/tasks/predict${isMoving ? '?tables=no' : ''}` : null, body);
  const {failure, refused, isWaiting} = reply;
  const isOther = reply.of && (reply.of.rig.name !== state.rig.name || reply.of.rig.text !== state.rig.text);
  const isUnpredicted = isOfRig(failure) && !isWaiting;
  const model = useReply('friction', isUnpredicted ? 'api/tasks/friction' : null, {rig: state.rig});
  /** @type {string} */
  const why = isUnpredicted && !model.isWaiting ? (model.content?.answer.predicted_friction_ratio?.reason ?? '') : '';
  const byModel = why ? model.content : null;
  const content = isOther || byModel ? null : reply.content;
  const {kept, keep, remove} = useKept(state, content);
  useEffect(
    () => (byModel ? offer('friction', {rig: state.rig}) : offer('predict', argumentsOf(state, false))),
    [JSON.stringify(body), Boolean(byModel)],
  );
  /** @param {string} key */
  const faultOf = (key) => failure?.faults.find((fault) => fault.key === key)?.text;
  const shown = [...Object.keys(state.rig.changes), 'pin', 'disc', 'lubricant'];
  const extra = html`<${Materials} view=${state.view} faultOf=${faultOf} isFirst=${!content && !failure} />`;
  const ownRuns = html`<${OwnRuns}
    view=${state.view}
    onFile=${onFile}
    note=${note}
    disagreeing=${content?.answer.disagreeing_runs}
  />`;
  const isDim = useLate(isWaiting || Boolean(failure));
  if (byModel) {
    const {rig, friction_model: name, friction_reduction: reduction} = byModel.answer;
    const share = `${Math.abs(Math.round(100 * reduction.value))} %`;
    const lead = html`
      <p class="overline">${rig}</p>
      <h1 class="statement" data-test="statement">
        ${`By its model alone (${words(name)}), friction ${reduction.value < 0 ? 'rises' : 'falls'} by ${share}.`}
      </h1>
      <p class="lead-likely" data-test="reason">Not predicted: ${reasonOf(why)}.</p>
    `;
    return html`<${Workspace} lead=${lead} extra=${extra} onFile=${onFile}>
      <${ByModel} answer=${byModel} reason=${reasonOf(why)} />
    <//>`;
  }
  if (!content) {
    const isPending = isWaiting || (isUnpredicted && model.isWaiting);
    return html`<${Workspace}
      extra=${extra}
      lead=${html`
        <p class="overline">Predict</p>
        <h1 class="statement is-pending">
          ${failure && !isPending ? 'No answer yet' : 'Computing the first answer…'}
        </h1>
        <${Failure} failure=${isPending ? null : failure} shown=${shown} />
      `}
    >
      ${failure && !isPending ? state.view.runs && ownRuns : html`<div class="skeleton" aria-hidden="true"></div>`}
    <//>`;
  }
  const [outcome, ...others] = content.answer.statement;
  const [first, likely, ...rest] = outcome.split(/(?<=\.) (?=[A-Z])/);
  const chart = content.charts[0];
  const lead = html`
    <p class="overline">${content.answer.rig}</p>
    <h1 class=${classes('statement', {'is-dim': isDim})} aria-live=${isMoving ? 'off' : 'polite'} data-test="statement">
      ${first}
    </h1>
    <div class="row lead-tools">
      <${Button} onClick=${keep} disabled=${isWaiting || Boolean(failure) || refused.length > 0} data-test="keep">
        Keep this
      <//>
      <span class="status" role="status" data-test="status">${isDim && !failure ? 'Computing…' : ''}</span>
    </div>
    <p class="lead-likely" data-test="likely">${likely}</p>
    <${Failure} failure=${failure} shown=${shown} />
    <${RefusedNote} refused=${refused} />
  `;
  return html`<${Workspace} lead=${lead} extra=${extra} onFile=${onFile}>
    <div class=${classes('first-screen', {'is-dim': isDim})} aria-busy=${isWaiting}>
      <${Changes} answer=${content} />
      <section class="card is-figure" aria-label="Friction over amplitude and over speed">
        ${
          chart &&
          html`<${Chart}
            ...${chart}
            dimmed=${isDim}
            drag=${dragOf(view, chart.chart)}
            kept=${kept.map(({label, answer}) => ({label, chart: answer.charts[0].chart}))}
          />`
        }
      </section>
      <${Surer} answer=${content} beside=${{pin, disc, runs}} />
      <${Numbers} answer=${content} />
      ${ownRuns}
      <${Kept} kept=${kept} now=${content} onRemove=${remove} />
      <div class="columns">
        <div class="stack">
          <${Sharpen} answer=${content} beside=${{pin, disc, runs}} />
        </div>
        <div class="stack">
          <${Card} id="more-title" title="In words">
            ${[rest.join(' '), ...others].filter(Boolean).map((line) => html`<p key=${line}>${line}</p>`)}
            ${
              /** @type {Block[]} */ (content.blocks)
                .slice(-2)
                .filter(({kind}) => kind === 'text')
                .map(({text}) => html`<p class="hint" key=${text}>${text}</p>`)
            }
          <//>
          <section class="card" aria-label="Caveats and assumptions">
            <${Caveats} answer=${content} isMoving=${isMoving || isWaiting} of=${JSON.stringify(reply.of)} />
          </section>
        </div>
      </div>
    </div>
  <//>`;
}
