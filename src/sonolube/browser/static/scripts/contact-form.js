/**
 * The contact of a rig as a sentence and a drawing that are the form: the values in the sentence are text fields, those
 * in the drawing lead to them, and the slider and the spread of the value in use stand below.
 */
import {html, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {EntryInput, Field, fieldId, focusField, printed} from './fields.js';
import {Refusal, useEvents} from './parts.js';

/**
 * @import {EntryProps, RigField} from './fields.js'
 * @typedef {{text?: string, key?: string}} Piece of the sentence: text, or the key of an entry
 * @typedef {{has_structure: boolean, has_drive: boolean, direction: string, vibrating_body: string}} Parts drawn
 * @typedef {{x: number, y: number, anchor: 'start'|'end', sign?: string}} Place
 */

/** Where the drawing shows values. @type {Record<string, Place>} */
const PLACES = {
  'drive.voltage_peak_to_peak': {x: 8, y: 22, anchor: 'start'},
  'drive.frequency': {x: 8, y: 40, anchor: 'start'},
  'contact.normal_load': {x: 148, y: 18, anchor: 'start'},
  'vibration.vibration_amplitude': {x: 192, y: 97, anchor: 'start'},
  'friction.friction_coefficient': {x: 8, y: 104, anchor: 'start', sign: 'µ '},
  'sliding.sliding_speed': {x: 176, y: 158, anchor: 'start'},
};
/** Those places that differ where the disc vibrates. @type {Record<string, Place>} */
const PLACES_BELOW = {
  'drive.voltage_peak_to_peak': {x: 8, y: 168, anchor: 'start'},
  'drive.frequency': {x: 8, y: 150, anchor: 'start'},
  'vibration.vibration_amplitude': {x: 262, y: 84, anchor: 'end'},
};

/**
 * Arrows of the vibration about its middle, by its direction; across the sliding it points out of the drawing.
 * @type {Record<string, string>}
 */
const VIBRATIONS = {
  normal: 'M0 -11 v22 m-4 -18 4 -5 4 5 m-8 13 4 5 4 -5',
  along: 'M-12 0 h24 m-19 -4 -5 4 5 4 m14 -8 5 4 -5 4',
  across: 'M-6 0 a6 6 0 1 0 12 0 a6 6 0 1 0 -12 0 m5 0 h2',
  torsional: 'M-12 2 a13 5 0 0 1 24 0 m-25 -4 1 4 4 0 m21 -4 -1 4 -4 0',
};

/**
 * Value of an entry beside its part; a press leads to its field in the sentence.
 * @param {{entry: EntryProps, place: Place}} props
 */
function Value({entry: {field, text}, place: {x, y, anchor, sign = ''}}) {
  const value = printed(text) || text;
  const shown = sign + (value.length > 13 ? `${value.slice(0, 12)}…` : value);
  const width = 7.4 * shown.length + 10;
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
 * Drawing of pin and disc, of load, sliding and vibration, with their values.
 * @param {{drawing: Parts, entries: EntryProps[]}} props
 */
function Schematic({drawing, entries}) {
  const isBelow = drawing.vibrating_body === 'disc';
  const places = isBelow ? {...PLACES, ...PLACES_BELOW} : PLACES;
  const word = drawing.direction === 'normal' ? '' : drawing.direction;
  return html`<svg class="schematic" viewBox="0 0 270 176" role="group" aria-label="Drawing of the rig with its values">
    <g class="schematic-lines" aria-hidden="true">
      ${
        drawing.has_structure &&
        html`<path d="M20 62 H112" class="thick" /><path d="M20 52 v20 M14 54 l6 6 M14 62 l6 6 M14 70 l6 6" />`
      }
      <path d="M135 4 v22 m-4 -6 4 6 4 -6 M96 153 H166 m-6 -4 6 4 -6 4" class="force" />
      <path
        d=${VIBRATIONS[drawing.direction] ?? VIBRATIONS.along}
        transform=${isBelow ? 'translate(248 108)' : 'translate(176 92)'}
        class="force"
        data-test=${`moves:${drawing.vibrating_body}`}
      />
      ${word && html`<text ...${isBelow ? {x: 230, y: 108, 'text-anchor': 'end'} : {x: 192, y: 110}}>${word}</text>`}
      <rect x="112" y="30" width="46" height="54" rx="3" class="part" />
      ${
        drawing.has_drive &&
        (isBelow
          ? html`<path d="M12 123 q4 -8 8 0 t8 0 M28 123 H40" class="wave" />`
          : html`
            <path d="M112 42 H158 M112 50 H158 M112 58 H158 M112 66 H158 M112 74 H158" class="thin" />
            <path d="M88 36 q4 -8 8 0 t8 0 M104 36 H112" class="wave" />
          `)
      }
      <path d="M118 84 H152 V100 L144 112 H126 L118 100 Z" class="part is-pin" />
      <path d="M126 112 H144" class="contact" />
      <path d="M74 103 L122 111" class="thin" />
      <rect x="40" y="113" width="190" height="20" rx="3" class="part is-disc" />
    </g>
    ${entries
      .filter(({field}) => field.key in places)
      .map((entry) => html`<${Value} key=${entry.field.key} entry=${entry} place=${places[entry.field.key]} />`)}
  </svg>`;
}

/**
 * The form: sentence, drawing, and what belongs to the value in use.
 * @param {{sentence: Piece[], drawing: Parts, entries: EntryProps[]}} props
 */
export function ContactForm({sentence, drawing, entries}) {
  const [inUse, use] = useState('');
  const lastKey = useRef('');
  useEvents(['keydown', 'pointerdown'], ({key = ''}) => (lastKey.current = key));
  const isByTab = () => lastKey.current === 'Tab';
  const byKey = new Map(entries.map((entry) => [entry.field.key, entry]));
  const shown = byKey.get(inUse) ?? entries[0];
  const refused = entries.filter((entry) => entry.refusal);
  return html`<section class="contact-form" aria-label="Contact">
    <p class="sentence" data-test="sentence">
      ${sentence.map(({text, key = ''}, at) => {
        const entry = byKey.get(key);
        return entry
          ? html`<${InSentence} ...${entry} isByTab=${isByTab} onUse=${() => use(key)} />`
          : html`<span key=${at}>${text}</span>`;
      })}
    </p>
    ${refused.map(
      ({field, refusal}) =>
        html`<${Refusal}
          key=${field.key}
          text=${refusal}
          id=${`${fieldId(field.key)}-refusal`}
          data-test=${`refusal:${field.key}`}
        />`,
    )}
    <${Schematic} drawing=${drawing} entries=${entries} />
    ${shown && html`<${Field} ...${shown} hasInput=${false} />`}
  </section>`;
}

/**
 * Value in the sentence, as wide as its text; pressed, typed or stepped, not only passed by the tab key, it is that in
 * use.
 * @param {EntryProps & {onUse: () => void, isByTab: () => boolean}} props
 */
function InSentence({onUse, isByTab, ...entry}) {
  const {field, text} = entry;
  const [draft, setDraft] = useState(/** @type {string|null} */ (null));
  const width = (draft ?? (printed(text) || text)).length;
  /** @param {KeyboardEvent} event */
  const press = ({key}) => !['Tab', 'Shift'].includes(key) && onUse();
  return html`<span onKeyDown=${press} 
    ><${EntryInput}
      ...${entry}
      class=${entry.isChanged ? 'in-sentence is-changed' : 'in-sentence'}
      size=${Math.min(Math.max(width, 3), 24)}
      aria-label=${field.label}
      onDraft=${setDraft}
      onFocus=${() => !isByTab() && onUse()}
    />${field.help && html`<span class="hidden" id=${`${fieldId(field.key)}-help`}>${field.help}</span>`}</span
  >`;
}
