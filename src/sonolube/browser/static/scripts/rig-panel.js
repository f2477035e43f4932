/**
 * Left column: which rig, its drawing, and its entries as fields; and the frame of a page that has it beside its
 * answer.
 */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {useReply} from './api.js';
import {Field, focusField, spreadKey} from './fields.js';
import {Button, FileButton, Loading, Refusal, Select, useDrop} from './parts.js';
import {addressOf, change, isOfTab, pack, setEntry, settle, useApp} from './state.js';

/**
 * @import {RigField} from './fields.js'
 * @import {FieldEvent} from './parts.js'
 * @import {RigState} from './state.js'
 * @typedef {{title: string, source?: string, rigs: string[], studies: string[], maps: string[], fields: RigField[],
 *   drawing: {has_structure: boolean, has_drive: boolean, direction: string}}} RigView as the server shows a rig
 */

/**
 * Where the drawing of a rig shows values.
 * @type {Record<string, {x: number, y: number, anchor: string, sign?: string}>}
 */
const PLACES = {
  'drive.voltage_peak_to_peak': {x: 8, y: 22, anchor: 'start'},
  'drive.frequency': {x: 8, y: 40, anchor: 'start'},
  'contact.normal_load': {x: 262, y: 22, anchor: 'end'},
  'vibration.vibration_amplitude': {x: 262, y: 84, anchor: 'end'},
  'friction.friction_coefficient': {x: 8, y: 104, anchor: 'start', sign: 'µ '},
  'sliding.sliding_speed': {x: 262, y: 155, anchor: 'end'},
};

/** Last view that was read and its rig, so that a page that opens shows it at once. */
let last = {view: /** @type {RigView|null} */ (null), rig: /** @type {Partial<RigState>} */ ({})};

/**
 * The rig of the state as the server shows it: title, fields, drawing, assumptions, names of rigs; `view` is null where
 * refused.
 */
export function useRig() {
  const {
    state: {rig},
    isMoving,
  } = useApp();
  const asked = useRef(rig);
  if (!isMoving || rig.name !== asked.current.name) asked.current = rig; // values that move are not asked about
  const {content, failure, refused, isWaiting, of} = useReply('rig', rig.name ? 'api/rig' : null, {rig: asked.current});
  if (content) last = {view: content, rig: of.rig};
  const isOther = last.rig.name !== rig.name || last.rig.text !== rig.text;
  return {view: failure && isOther ? null : last.view, failure, refused, isWaiting};
}

/**
 * Text of an entry: as it was typed, else as the file has it.
 * @param {RigState} rig
 * @param {RigField} field
 */
const textOf = (rig, field) => rig.changes[field.key] ?? field.text;

/** @param {RigField} field */
const tableOf = (field) => field.key.slice(0, field.key.lastIndexOf('.'));

/**
 * Chooser of a rig: the examples, the one that was opened, an own file.
 * @param {{view: RigView|null}} props
 */
export function RigChoice({view}) {
  const {state} = useApp();
  const own = state.rig.text !== undefined;
  const names = [
    ...new Set([...(own ? [state.rig.name] : []), ...(view?.rigs ?? last.view?.rigs ?? []), state.rig.name]),
  ].filter(Boolean);
  const choices = names.map((name) => (own && name === state.rig.name ? ['', `${name} (own file)`] : [name, name]));
  /** @param {FieldEvent} event */
  const choose = (event) =>
    change({rig: {name: event.target.value, changes: {}}, view: {pin: null, disc: null, runs: null, lost: null}});
  return html`<div class="rig-choice">
    <div class="row">
      <label for="rig-name" class="grow">Rig</label>
      <${FileButton} accept=".toml" label="Rig file" onFile=${openRig} test="rig-file" data-test="open-rig">Open…<//>
      <a class="button" href=${addressOf('new')}>New…</a>
    </div>
    <${Select} id="rig-name" choices=${choices} value=${own ? '' : state.rig.name} onChange=${choose} data-test="rig" />
    ${view && html`<p class="hint" data-test="rig-title">${view.title}</p>`}
    ${
      isOfTab(state.rig.text) &&
      html`<p class="hint" role="status" data-test="of-tab">
        This file is too long for a link: it stays in this tab only. Take it away as TOML to keep it.
      </p>`
    }
    <${Refusal}
      role="alert"
      data-test="lost"
      text=${
        state.view.lost &&
        `The file of ${state.view.lost} is not in this link and no longer in this browser: open it again.`
      }
    />
  </div>`;
}

/**
 * Value of an entry beside its part.
 * @param {{field: RigField, text: string}} props
 */
function Value({field, text}) {
  const {x, y, anchor, sign = ''} = PLACES[field.key];
  const shown = sign + (text.length > 13 ? `${text.slice(0, 12)}…` : text);
  const width = 7 * shown.length + 10;
  /** @param {UIEvent & {key?: string}} event */
  const edit = (event) => {
    if (event.type === 'keydown' && event.key !== 'Enter' && event.key !== ' ') return;
    event.preventDefault();
    focusField(field.key);
  };
  return html`<g
    role="button"
    tabindex="0"
    class="schematic-value"
    aria-label=${`${shown}, ${field.label}. Edit`}
    onClick=${edit}
    onKeyDown=${edit}
    data-test=${`drawn:${field.key}`}
  >
    <rect x=${anchor === 'end' ? x - width + 5 : x - 5} y=${y - 13} width=${width} height="18" rx="4" />
    <text x=${x} y=${y} text-anchor=${anchor}>${shown}</text>
  </g>`;
}

/**
 * Arrows of the vibration by its direction; across the sliding it points out of the drawing.
 * @type {Record<string, string>}
 */
const VIBRATIONS = {
  normal: 'M168 90 v22 m-3 -17 3 -5 3 5 m-6 12 3 5 3 -5',
  along: 'M164 104 h24 m-19 -3 -5 3 5 3 m14 -6 5 3 -5 3',
  across: 'M162 102 a6 6 0 1 0 12 0 a6 6 0 1 0 -12 0 m5 0 h2',
  torsional: 'M163 106 a13 5 0 0 1 24 0 m-25 -4 1 4 4 0 m21 -4 -1 4 -4 0',
};

/**
 * Drawing of a rig with its values; a click on a value opens its field.
 * @param {{drawing: RigView['drawing'], fields: RigField[], rig: RigState}} props
 */
const Schematic = ({
  drawing,
  fields,
  rig,
}) => html`<svg class="schematic" viewBox="0 0 270 172" role="group" aria-label="Drawing of the rig with its values">
  <g class="schematic-lines" aria-hidden="true">
    ${
      drawing.has_structure &&
      html`<path d="M20 62 H112" class="thick" /><path d="M20 52 v20 M14 54 l6 6 M14 62 l6 6 M14 70 l6 6" />`
    }
    <path d="M135 6 v22 m-4 -6 4 6 4 -6 M96 150 H166 m-6 -4 6 4 -6 4" class="force" />
    <path d=${VIBRATIONS[drawing.direction] ?? VIBRATIONS.along} class="force" />
    ${drawing.direction !== 'normal' && html`<text x="194" y="108">${drawing.direction}</text>`}
    <rect x="112" y="32" width="46" height="52" rx="3" class="part" />
    ${
      drawing.has_drive &&
      html`
        <path d="M112 42 H158 M112 50 H158 M112 58 H158 M112 66 H158 M112 74 H158" class="thin" />
        <path d="M88 36 q4 -8 8 0 t8 0 M104 36 H112" class="wave" />
      `
    }
    <path d="M118 84 H152 V100 L144 112 H126 L118 100 Z" class="part is-pin" />
    <path d="M126 112 H144" class="contact" />
    <path d="M74 103 L122 111" class="thin" />
    <rect x="40" y="113" width="190" height="20" rx="3" class="part is-disc" />
  </g>
  ${fields
    .filter(({key}) => key in PLACES)
    .map((field) => html`<${Value} key=${field.key} field=${field} text=${textOf(rig, field)} />`)}
</svg>`;

/**
 * Make the text of a rig file the rig of the state, and go to a page.
 * @param {string} name
 * @param {string} text
 * @param {string} [page]
 * @returns {Promise<void>}
 */
export async function openRigText(name, text, page = undefined) {
  await pack(text);
  change({...(page && {page}), rig: {name, text, changes: {}}, view: {lost: null}});
}

/** @param {File} file */
const openRig = async (file) => openRigText(file.name.replace(/\.toml$/i, ''), await file.text());

/**
 * Rig with its drawing and fields; `extra` stands below those of the operating point.
 * @param {{extra?: any}} props
 */
export function RigPanel({extra}) {
  const {
    state: {rig},
  } = useApp();
  const {view, failure, refused} = useRig();
  const answered = failure && ['refused', 'busy'].includes(failure.kind) ? failure.faults : []; // else the head says it
  const faults = new Map([...answered, ...refused].map(({key, text}) => [key, text]));
  /** @param {string} key @param {string|null} text @param {boolean} isMoving */
  const onText = (key, text, isMoving) => setEntry(key, text, {replace: isMoving});
  const fields = view?.fields ?? [];
  const first = fields.filter((field) => field.is_first);
  const others = fields.filter((field) => !field.is_first);
  const placed = new Set(fields.flatMap((field) => [field.key, spreadKey(field.key)]));
  const homeless = [...faults].filter(([key]) => !placed.has(key));
  const isAll = others.some((field) => faults.has(field.key));
  const entries = useRef(null);
  useEffect(() => {
    if (isAll) entries.current.open = true; // an entry beyond the operating point is refused
  }, [isAll]);
  /** @param {RigField[]} some */
  const list = (some) =>
    some.map(
      (field) => html`<${Field}
        key=${`${rig.name} ${field.key}`}
        field=${field}
        text=${textOf(rig, field)}
        spread=${rig.changes[spreadKey(field.key)]}
        isChanged=${field.key in rig.changes}
        refusal=${faults.get(field.key)}
        spreadRefusal=${faults.get(spreadKey(field.key))}
        onText=${onText}
        onSettle=${settle}
      />`,
    );
  const count = Object.keys(rig.changes).length;
  return html`<aside class="rig" aria-label="Rig" data-test="rig-panel">
    <${RigChoice} view=${view} />
    ${!view && !failure && html`<${Loading}>Reading the rig…<//>`}
    ${view && html`<${Schematic} drawing=${view.drawing} fields=${fields} rig=${rig} />`}
    ${homeless.map(([key, text]) => html`<${Refusal} key=${key} text=${text} role="alert" data-test="rig-refusal" />`)}
    <div class="fields">${list(first)}</div>
    ${
      count > 0 &&
      html`<${Button}
        kind="button is-quiet"
        onClick=${() => change({rig: {...rig, changes: {}}})}
        data-test="reset-all"
      >
        Take back ${count === 1 ? 'the change' : `all ${count} changes`}
      <//>`
    }
    ${extra}
    ${
      others.length > 0 &&
      html`<details ref=${entries} class="all-entries" data-test="all-entries">
        <summary>All entries</summary>
        ${[...new Set(others.map(tableOf))].map(
          (table) => html`<fieldset key=${table} class="fields">
            <legend>${table}</legend>
            ${list(others.filter((field) => tableOf(field) === table))}
          </fieldset>`,
        )}
      </details>`
    }
    ${view?.source && html`<p class="hint source">Source: ${view.source}</p>`}
  </aside>`;
}

/**
 * Frame of a page with the rig: the lead above its answer (sticky on narrow screens), the rig, the answer; `onFile`
 * takes what is dropped beside a rig.
 * @param {{lead: any, extra?: any, onFile?: (file: File) => void, children: any}} props
 */
export function Workspace({lead, extra, onFile, children}) {
  const isDropping = useDrop((files) =>
    files.forEach((file) => (/\.toml$/i.test(file.name) ? openRig : onFile)?.(file)),
  );
  return html`<div class="workspace">
    <div class="lead" id="answer" tabindex="-1">${lead}</div>
    <${RigPanel} extra=${extra} />
    <div class="body">${children}</div>
    ${isDropping && html`<div class="drop" aria-hidden="true">Drop the rig${onFile && ' or the runs'} here</div>`}
  </div>`;
}
