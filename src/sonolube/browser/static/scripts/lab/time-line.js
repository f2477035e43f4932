/** Steps of a protocol as blocks along time, in lanes; the fields of the chosen one, and what changes the steps. */
import {html, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Labelled, refusedBy, TextField} from '../fields.js';
import {duration} from '../job.js';
import {Button, capital, classes, Refusal, Select, words} from '../parts.js';

/**
 * @typedef {{key: string, label: string, kind: string, text: string, unit?: string, choices?: string[]}} ProtocolField
 * @typedef {{number: string, kind: string, label: string, start: number, duration: number, depth: number, lane: string,
 *   fields: ProtocolField[]}} Step
 * @typedef {{key: string, typed: string, text: string}} Wrong entry that was refused: what was typed, and the reason
 */
const [NARROW, WIDE] = [64, 720]; // px of a step without a duration, and of all that have one

/**
 * Duration that a step adds to the test; recordings go on beside the steps that follow.
 * @param {Step} step
 */
const lasting = (step) => (['repeat', 'record'].includes(step.lane) ? 0 : step.duration);

/**
 * Place after the last column of a block: set points last until the next ones, recordings their time, repeats as their
 * steps.
 * @param {Step[]} steps
 * @param {number} at
 */
function endOf(steps, at) {
  const step = steps[at];
  const {lane} = step;
  if (lane === 'steps') return at + 1;
  /** @param {Step} other */
  const ends = (other) =>
    lane === 'repeat'
      ? other.depth <= step.depth
      : other.lane === lane ||
        (lane === 'record' && (other.start >= step.start + step.duration || other.depth < step.depth));
  const next = steps.findIndex((other, place) => place > at && ends(other));
  return next < 0 ? steps.length : next;
}

/**
 * What stands on a block: its entries, or its kind.
 * @param {Step} step
 */
const textOf = ({label, fields}) =>
  fields
    .filter(({kind, text}) => text && kind !== 'flag')
    .map(({text}) => text)
    .join(', ') || label;

/**
 * Number of the step so many further in its list of steps.
 * @param {string} number
 * @param {number} by
 */
const beside = (number, by) => [...number.split('.').slice(0, -1), Number(number.split('.').at(-1)) + by].join('.');

/**
 * Entry of a protocol; what was refused of it stays as it was typed, with the reason below.
 * @param {{field: ProtocolField, wrong: Wrong|null, set: (key: string, typed: string) => void}} props
 */
function Entry({field, wrong, set}) {
  const id = `entry-${field.key.replaceAll('.', '-')}`;
  const own = wrong?.key === field.key ? wrong : null;
  const refusal = own?.text ?? '';
  const text = refusal ? own?.typed : field.text;
  const shared = {id, 'data-test': `entry:${field.key}`, ...refusedBy(id, refusal)};
  const choices = field.kind === 'flag' ? ['true', 'false'] : field.choices;
  return html`<${Labelled} id=${id} label=${capital(field.label)} refusal=${refusal}>
    ${
      choices?.length
        ? html`<${Select}
          choices=${['', ...choices].map((each) => [each, words(each) || 'usual'])}
          value=${text}
          onChange=${(event) => set(field.key, event.target.value)}
          ...${shared}
        />`
        : html`<${TextField}
          text=${text}
          unit=${field.unit}
          onText=${(typed, isMoving) => !isMoving && set(field.key, typed)}
          onSettle=${() => null}
          ...${shared}
        />`
    }
  <//>`;
}

/**
 * The time line above what stands in two columns: entries of the chosen step with `start` below them, and `children`.
 * @param {{protocol: {steps: Step[], kinds: string[], lanes: string[], limits: ProtocolField[],
 *   metadata: ProtocolField[]},
 *   edit: (changes: object) => Promise<boolean>, wrong: Wrong|null, start: any, children: any}} properties
 */
export function TimeLine({protocol: {steps, kinds, lanes: known, limits, metadata}, edit, wrong, start, children}) {
  const [chosen, choose] = useState('1');
  const [kind, setKind] = useState(kinds[0]);
  const line = useRef(null);
  const at = Math.max(
    0,
    steps.findIndex(({number}) => number === chosen),
  );
  const step = steps[at];
  /** @param {string} number */
  const has = (number) => steps.some((other) => other.number === number);
  const whole = steps.reduce((sum, each) => sum + lasting(each), 0) || 1;
  const widths = steps.map((each) => Math.round(Math.max(NARROW, (WIDE * lasting(each)) / whole)));
  const lanes = known.filter((lane) => lane !== 'repeat' || steps.some((each) => each.lane === lane));

  /** @param {object} changes @param {string} [next] */
  const change = async (changes, next = step.number) => (await edit(changes)) && choose(next);
  /** @param {string} key @param {string} typed */
  const set = (key, typed) => change({[key]: typed});
  /** @param {number} by */
  const move = (by) =>
    has(beside(step.number, by)) &&
    change({move: {step: step.number, before: beside(step.number, by > 0 ? 2 : -1)}}, beside(step.number, by));
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    /** @type {Record<string, number>} */
    const moves = {ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: steps.length - 1};
    const to = moves[event.key];
    if (to === undefined) return;
    event.preventDefault();
    if (event.altKey) move(to - at);
    else if (steps[to]) {
      choose(steps[to].number);
      line.current.querySelectorAll('button')[to].focus();
    }
  };
  /** @param {ProtocolField[]} fields */
  const entries = (fields) =>
    fields.map((field) => html`<${Entry} key=${field.key} field=${field} wrong=${wrong} set=${set} />`);
  return html`<div data-test="time-line">
    <div
      class="lanes table-frame"
      style=${{gridTemplateColumns: ['max-content', ...widths.map((width) => `${width}px`)].join(' ')}}
      ref=${line}
      onKeyDown=${press}
      role="listbox"
      aria-orientation="horizontal"
      aria-label="Steps along time"
    >
      ${lanes.map(
        (lane, row) =>
          html`<span key=${lane} class="lane" style=${{gridRow: row + 1}} aria-hidden="true">${capital(lane)}</span>`,
      )}
      ${steps.map(
        (each, place) => html`<button
          type="button"
          key=${each.number}
          role="option"
          aria-selected=${place === at}
          tabindex=${place === at ? 0 : -1}
          class=${classes(`block is-${each.lane}`, {'is-chosen': place === at})}
          onClick=${() => choose(each.number)}
          title=${`${words(each.kind)}: ${textOf(each)}`}
          data-test=${`step:${each.number}`}
          style=${{gridRow: lanes.indexOf(each.lane) + 1, gridColumn: `${place + 2} / ${endOf(steps, place) + 2}`}}
        >
          <b>${each.number}</b> ${textOf(each)}
        </button>`,
      )}
      ${steps.map(
        ({start}, place) =>
          html`<span
            key=${place}
            class="lane-time"
            style=${{gridRow: lanes.length + 1, gridColumn: place + 2}}
            aria-hidden="true"
          >
            ${duration(start)}
          </span>`,
      )}
    </div>
    <div class="row">
      <${Button}
        onClick=${() => move(-1)}
        disabled=${!has(beside(step.number, -1))}
        aria-keyshortcuts="Alt+ArrowLeft"
        data-test="earlier"
      >
        ← Earlier
      <//>
      <${Button}
        onClick=${() => move(1)}
        disabled=${!has(beside(step.number, 1))}
        aria-keyshortcuts="Alt+ArrowRight"
        data-test="later"
      >
        Later →
      <//>
      <${Button}
        onClick=${() =>
          change({remove: step.number}, has(beside(step.number, 1)) ? step.number : beside(step.number, -1))}
        data-test="remove"
      >
        Remove
      <//>
      <span class="grow"></span>
      <label for="new-step">New step</label>
      <${Select}
        id="new-step"
        choices=${kinds.map((each) => [each, words(each)])}
        value=${kind}
        onChange=${(event) => setKind(event.target.value)}
        data-test="new-step"
      />
      <${Button}
        onClick=${() => change({insert: {before: beside(step.number, 1), kind}}, beside(step.number, 1))}
        data-test="insert"
      >
        Insert after ${step.number}
      <//>
    </div>
    <${Refusal}
      text=${wrong && ['insert', 'remove', 'move'].includes(wrong.key) && wrong.text}
      role="alert"
      data-test="edit-refusal"
    />
    <div class="columns">
      <div class="stack">
        <fieldset class="fields two" data-test="step">
          <legend>
            Step ${step.number}, ${words(step.kind)}: from ${duration(step.start)}, ${duration(step.duration)}
          </legend>
          ${entries(step.fields)}
        </fieldset>
        <details open><summary>Limits</summary><div class="fields two">${entries(limits)}</div></details>
        <details><summary>What is tested</summary><div class="fields two">${entries(metadata)}</div></details>
        ${start}
      </div>
      ${children}
    </div>
  </div>`;
}
