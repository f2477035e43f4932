/**
 * Fields: entries of a rig as number and unit, with slider and spread; materials and uploaded files beside the rig;
 * what is refused below them.
 */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, useReply} from './api.js';
import {isInFolder} from './folder-runs.js';
import {Button, classes, FileButton, Refusal, Select} from './parts.js';
import {change} from './state.js';
/**
 * @import {FieldEvent} from './parts.js'
 * @import {Texts} from './state.js'
 * @typedef {{key: string, label: string, text: string, unit: string, lowest?: number, highest?: number, help?: string,
 *   assumed?: string, is_first?: boolean, numbers: Record<string, number>}} RigField as the server describes an entry
 */

const SLIDER_STEPS = 400;
const PAUSE = 300; // ms after the last key until a text is read
const REST = 500; // ms without a key until a value is entered into the history
const BODIES = [
  ['pin', 'Material of the pin'],
  ['disc', 'Material of the disc'],
];
/** @type {Record<string, number>} */
const DIRECTIONS = {ArrowUp: 1, ArrowDown: -1};
export const NOTHING = {};
const COMMA = /^(\s*[+-]?\d*),(\d+)(?![\d.,])/; // of a decimal number, as much of the world writes it
const MICRO = /^(\s*[+-]?[\d.]+(?:e[+-]?\d+)?\s*)[µμ](?=[A-Za-z])/i;
const NUMBER = /^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)(.*)$/is;

/** @param {string} key @returns {string} */
export const fieldId = (key) => `field-${key.replaceAll(/[^\w]/g, '-')}`;
/** @param {string} key @returns {string} */
export const spreadKey = (key) => `uncertainty.${key}`;

/**
 * Show the field of an entry, or the first of a table, open what it lies in, and put the cursor into it; false where
 * there is none.
 * @param {string} key
 * @returns {boolean}
 */
export function focusField(key) {
  /** @type {HTMLInputElement|null} */
  const first = document.querySelector(`input[id^="${fieldId(key)}-"]`);
  const field = /** @type {HTMLInputElement|null} */ (document.getElementById(fieldId(key))) ?? first;
  if (!field) return false;
  for (let around = field.closest('details'); around; around = around.parentElement?.closest('details') ?? null)
    around.open = true;
  field.scrollIntoView({
    block: 'center',
    behavior: matchMedia('(prefers-reduced-motion: reduce)').matches ? 'auto' : 'smooth',
  });
  field.focus({preventScroll: true});
  field.select?.();
  return true;
}

/**
 * Number at the beginning of a text and what follows; null where there is none.
 * @param {string} text
 * @returns {{number: number, rest: string, digits: string}|null}
 */
export function split(text) {
  const found = NUMBER.exec(text);
  const number = Number(found?.[1]);
  return found && Number.isFinite(number) ? {number, rest: found[2], digits: found[1]} : null;
}

/**
 * Text of a value as it is understood: a point for a decimal comma, um for µm, and the unit of the field for a bare
 * number.
 * @param {string} text
 * @param {string} unit of the field; empty for none
 * @returns {string}
 */
export function understood(text, unit) {
  const number = text.replace(COMMA, '$1.$2').replace(MICRO, '$1u');
  return unit && split(number)?.rest.trim() === '' ? `${number.trim()} ${unit}` : number;
}

/**
 * Value as it is printed: one space before its unit, and a micro sign; empty where it is no number.
 * @param {string} text
 * @returns {string}
 */
export function printed(text) {
  const parts = split(text);
  const unit = parts?.rest.trim().replace(/^[uμ](?=[A-Za-z])/, 'µ');
  return parts ? [parts.digits, unit].filter(Boolean).join(' ') : '';
}

/**
 * Number as it is typed, with three significant digits, and its unit.
 * @param {number} number
 * @param {string} unit
 * @returns {string}
 */
export const typed = (number, unit) => [String(Number(number.toPrecision(3))), unit].filter(Boolean).join(' ');

/**
 * Text with its number one step up or down: one in its second digit, or ten of these.
 * @param {string} text
 * @param {number} direction
 * @param {boolean} isLarge
 */
function stepped(text, direction, isLarge) {
  const parts = split(text);
  if (!parts) return text;
  const size = parts.number === 0 ? 0 : Math.floor(Math.log10(Math.abs(parts.number) * (1 + 1e-12)));
  const shown = (parts.digits.split(/e/i)[0].split('.')[1] ?? '').length;
  const power = Math.max(size - 1, -12);
  const number = parts.number + direction * (isLarge ? 10 : 1) * 10 ** power;
  const digits = /e/i.test(parts.digits)
    ? String(Number(number.toPrecision(4)))
    : number.toFixed(Math.max(-power, shown, 0));
  return `${digits}${parts.rest}`;
}

/**
 * Text field that is read after a pause, on Enter and when it is left.
 * @param {{id: string, text: string, unit?: string, onText: (text: string, isMoving: boolean) => void,
 *   onSettle: () => void, onDraft?: (text: string|null) => void, [name: string]: any}} props `unit`
 *   is of a value, empty for a pure number; `onDraft` follows each key; further ones go to the input
 */
export function TextField({id, text, unit, onText, onSettle, onDraft, ...rest}) {
  const [draft, setDraft] = useState(null);
  const timer = useRef(0);
  const latest = useRef(/** @type {string|null} */ (null));
  latest.current = draft;
  /** @param {() => void} work @param {number} pause */
  const later = (work, pause) => {
    clearTimeout(timer.current);
    timer.current = setTimeout(work, pause);
  };
  /** @param {string|null} typed */
  const put = (typed) => {
    latest.current = typed;
    setDraft(typed);
    onDraft?.(typed);
  };
  /** @param {string} typed */
  const withUnit = (typed) => (unit === undefined ? typed : understood(typed, unit));
  /** @param {boolean} isFinal */
  const give = (isFinal) => {
    clearTimeout(timer.current);
    if (latest.current !== null && withUnit(latest.current) !== withUnit(text))
      onText(withUnit(latest.current), !isFinal);
    if (isFinal) put(null);
  };
  useEffect(() => () => clearTimeout(timer.current), []);
  const leave = () => {
    give(true);
    onSettle();
  };
  /** @param {FieldEvent} event */
  const type = (event) => {
    put(event.target.value);
    later(() => {
      give(false);
      later(onSettle, REST);
    }, PAUSE);
  };
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    if (event.key === 'Enter') leave();
    const direction = DIRECTIONS[event.key];
    if (!direction) return;
    const typed = latest.current ?? text;
    const next = stepped(typed, direction, event.shiftKey);
    event.preventDefault();
    if (next === typed) return;
    put(null);
    onText(withUnit(next), true);
    later(onSettle, REST);
  };
  return html`<input
    type="text"
    id=${id}
    value=${draft ?? text}
    onInput=${type}
    onKeyDown=${press}
    onBlur=${leave}
    autocomplete="off"
    spellcheck=${false}
    maxlength="20000"
    ...${rest}
  />`;
}

/**
 * Slider over the usual range of a value, by decades where it spans more than one.
 * @param {{field: RigField, text: string, onText: (text: string, isMoving: boolean) => void, onSettle: () => void}}
 *   props
 */
function Slider({field, text, onText, onSettle}) {
  const {lowest = 1, highest = 1, unit, label, key} = field;
  const parts = split(text);
  const place = parts ? Math.log(Math.max(parts.number, lowest) / lowest) / Math.log(highest / lowest) : 0;
  /** @param {FieldEvent} event */
  const move = (event) => {
    const number = lowest * (highest / lowest) ** (Number(event.target.value) / SLIDER_STEPS);
    onText(typed(number, unit), true);
  };
  return html`<input
    type="range"
    class="slider"
    min="0"
    max=${SLIDER_STEPS}
    step="1"
    value=${Math.round(SLIDER_STEPS * Math.min(Math.max(place, 0), 1))}
    onInput=${move}
    onChange=${onSettle}
    aria-label=${`${label}, slider`}
    aria-valuetext=${text}
    data-test=${`slider:${key}`}
  />`;
}

/**
 * Field below its label, with its refusal.
 * @param {{id: string, label: string, refusal?: string, children: any}} properties
 */
export const Labelled = ({id, label, refusal, children}) => html`<div class="field">
  <label for=${id}>${label}</label>
  ${children}
  <${Refusal} text=${refusal} id=${`${id}-refusal`} />
</div>`;

/**
 * What a field says of its refusal, which stands below it by the id of the field.
 * @param {string} id
 * @param {string} [refusal]
 * @returns {object}
 */
export const refusedBy = (id, refusal) =>
  refusal ? {'aria-invalid': 'true', 'aria-describedby': `${id}-refusal`} : {};

/**
 * @typedef {{field: RigField, text: string, spread?: string, isChanged: boolean, refusal?: string, spreadRefusal?:
 *   string, onText: (key: string, text: string|null, isMoving: boolean) => void, onSettle: () => void}} EntryProps
 *   `onText` with null takes a change back
 */

/**
 * Text field of an entry of a rig.
 * @param {EntryProps & {[name: string]: any}} props further ones go to the input
 */
export function EntryInput({field, text, refusal, onText, onSettle, spread, isChanged, spreadRefusal, ...rest}) {
  const id = fieldId(field.key);
  const described = [refusal && `${id}-refusal`, field.help && `${id}-help`].filter(Boolean).join(' ') || undefined;
  return html`<${TextField}
    id=${id}
    text=${printed(text) || text}
    unit=${field.unit}
    onText=${(given, isMoving) => onText(field.key, given, isMoving)}
    onSettle=${onSettle}
    title=${field.help || undefined}
    aria-invalid=${refusal ? 'true' : undefined}
    aria-describedby=${described}
    data-test=${`field:${field.key}`}
    ...${rest}
  />`;
}

/**
 * Name of an entry, and the button that takes its change back.
 * @param {EntryProps & {isLabel?: boolean}} props
 */
function EntryHead({field, isChanged, onText, isLabel = true}) {
  const name = html`${field.label}${field.assumed && html` <span class="tag" title=${field.assumed}>assumed</span>`}`;
  return html`<div class="field-head">
    ${isLabel ? html`<label for=${fieldId(field.key)}>${name}</label>` : html`<span class="field-name">${name}</span>`}
    ${
      isChanged &&
      html`<${Button}
        kind="small"
        onClick=${() => onText(field.key, null, false)}
        aria-label=${`Take back the change of ${field.label}`}
        data-test=${`reset:${field.key}`}
      >
        take back
      <//>`
    }
  </div>`;
}

/**
 * Entry of a rig with its slider and spread; without its text field where that stands elsewhere.
 * @param {EntryProps & {hasInput?: boolean}} props
 */
export function Field({hasInput = true, ...entry}) {
  const {field, text, spread, isChanged, refusal, spreadRefusal, onText, onSettle} = entry;
  const id = fieldId(field.key);
  const [isSpread, setSpread] = useState(false);
  const hasSlider = field.lowest != null && field.highest != null;
  const isNumber = hasSlider || split(field.text) !== null;
  const shown = isSpread || spread !== undefined;
  /** @param {string} given @param {boolean} isMoving */
  const give = (given, isMoving) => onText(field.key, given, isMoving);
  const open = () => {
    if (spread !== undefined) onText(spreadKey(field.key), null, false);
    setSpread(!shown);
  };
  const slider = hasSlider && html`<${Slider} field=${field} text=${text} onText=${give} onSettle=${onSettle} />`;
  return html`<div class=${classes('field', {'is-refused': refusal, 'is-changed': isChanged})}>
    <${EntryHead} ...${entry} isLabel=${hasInput} />
    <div class="field-row">
      ${hasInput ? html`<${EntryInput} ...${entry} />` : slider}
      ${
        isNumber &&
        html`<${Button}
          kind="spread-button"
          aria-expanded=${shown}
          onClick=${open}
          aria-label=${`Spread of ${field.label}`}
          title="Give the spread of this value"
          data-test=${`spread-button:${field.key}`}
        >
          ±
        <//>`
      }
    </div>
    ${hasInput && slider}
    ${hasInput && html`<${Refusal} text=${refusal} id=${`${id}-refusal`} data-test=${`refusal:${field.key}`} />`}
    ${
      shown &&
      html`<div class="field-spread">
        <label for=${`${id}-spread`}>Spread</label>
        <${TextField}
          id=${`${id}-spread`}
          text=${spread ?? ''}
          placeholder="normal 5 %"
          onText=${(given, isMoving) => onText(spreadKey(field.key), given.trim() === '' ? null : given, isMoving)}
          onSettle=${onSettle}
          aria-invalid=${spreadRefusal ? 'true' : undefined}
          aria-describedby=${`${id}-spread-help`}
          data-test=${`spread:${field.key}`}
        />
        <p class=${spreadRefusal ? 'refusal' : 'hint'} id=${`${id}-spread-help`}>
          ${spreadRefusal || 'As in a rig file: normal 5 %, uniform 20 %, lognormal 10 %, or uniform with two values.'}
        </p>
      </div>`
    }
    ${hasInput && field.help && html`<span class="hidden" id=${`${id}-help`}>${field.help}</span>`}
  </div>`;
}

/**
 * Argument of a task by the text of a view that names an upload, which lasts as long as the workbench.
 * @param {string} text
 * @returns {{name: string, upload: string}}
 */
export const uploadOf = (text) => ({name: text.slice(text.indexOf(' ') + 1), upload: text.split(' ')[0]});

/**
 * Upload of a file that an entry of the view then names: what was refused of the last one, and what takes one.
 * @param {string} entry
 * @returns {[string, (file?: File) => Promise<void>]}
 */
export function useFile(entry) {
  const [note, setNote] = useState('');
  /** @param {File|undefined} file */
  const take = async (file) => {
    const reply = file && (await ask('api/uploads', {raw: file}));
    if (reply?.content) change({view: {[entry]: `${reply.content.upload} ${file?.name}`}});
    setNote(reply?.failure?.text ?? '');
  };
  return [note, take];
}

/**
 * Choices of the materials of pin and disc; `faultOf` gives the refusal of one.
 * @param {{view: Texts, faultOf: (name: string) => string|undefined, isAsked?: boolean}} props
 */
export function MaterialChoices({view, faultOf, isAsked = true}) {
  const names = Object.entries(useReply('materials', isAsked ? 'api/materials' : null, NOTHING).content ?? {});
  return BODIES.map(([body, label]) => {
    const [id, chosen, fault] = [`material-${body}`, view[body], faultOf(body)];
    const isUnlisted = chosen && !names.some(([name]) => name === chosen);
    const choices = [['', 'as in the rig'], ...(isUnlisted ? [[chosen, chosen]] : []), ...names];
    return html`<${Labelled} key=${body} id=${id} label=${label} refusal=${fault}>
      <${Select}
        id=${id}
        choices=${choices}
        value=${chosen ?? ''}
        data-test=${`material:${body}`}
        ...${refusedBy(id, fault)}
        onChange=${(event) => change({view: {[body]: event.target.value || null}})}
      />
    <//>`;
  });
}

/**
 * Buttons that choose a table of own runs, and leave it out.
 * @param {{view: Texts, onFile: (file: File) => void}} props
 */
export const RunsChoice = ({view, onFile}) => html`<p class="row">
  <${FileButton}
    id="own-runs"
    accept=".csv,.tsv,.txt,.xlsx,.ods"
    label="Own runs"
    onFile=${onFile}
    test="runs-file"
    data-test="choose-runs"
  >
    ${isInFolder() ? 'Add runs of a file…' : view.runs ? 'Choose other runs…' : 'Choose own runs…'}
  <//>
  ${
    view.runs &&
    !isInFolder() &&
    html`
      <strong class="grow">${uploadOf(view.runs).name}</strong>
      <${Button} kind="small" onClick=${() => change({view: {runs: null}})} data-test="remove-runs">leave out<//>
    `
  }
</p>`;
