/** Drawing of a rig with its values; a click on a value opens its field. */
import {html} from '../vendor/htm-preact-3.1.1.js';
import {focusField} from './fields.js';

const PLACES = {
  'drive.voltage_peak_to_peak': {x: 8, y: 22, anchor: 'start'},
  'drive.frequency': {x: 8, y: 40, anchor: 'start'},
  'contact.normal_load': {x: 262, y: 22, anchor: 'end'},
  'vibration.vibration_amplitude': {x: 262, y: 84, anchor: 'end'},
  'friction.friction_coefficient': {x: 8, y: 104, anchor: 'start', sign: 'µ '},
  'sliding.sliding_speed': {x: 262, y: 155, anchor: 'end'},
};

const focus = (key) => (event) => {
  if (event.type === 'keydown' && event.key !== 'Enter' && event.key !== ' ') return;
  event.preventDefault();
  focusField(key);
};

/** Value of an entry beside its part. */
function Value({field, text}) {
  const {x, y, anchor, sign = ''} = PLACES[field.key];
  const shown = sign + (text.length > 13 ? `${text.slice(0, 12)}…` : text);
  const width = 7 * shown.length + 10;
  return html`<g role="button" tabindex="0" class="schematic-value" aria-label=${`${shown}, ${field.label}. Edit`}
    onClick=${focus(field.key)} onKeyDown=${focus(field.key)} data-test=${`drawn:${field.key}`}>
    <rect x=${anchor === 'end' ? x - width + 5 : x - 5} y=${y - 13} width=${width} height="18" rx="4" />
    <text x=${x} y=${y} text-anchor=${anchor}>${shown}</text></g>`;
}

/** Drawing of a rig; `textOf` gives the text of a field. */
export function Schematic({drawing, fields, textOf}) {
  const shown = fields.filter((field) => field.key in PLACES);
  return html`<svg class="schematic" viewBox="0 0 270 172" role="group" aria-label="Drawing of the rig with its values">
    <g class="schematic-lines" aria-hidden="true">
      ${drawing.has_structure && html`<path d="M20 62 H112" class="thick" /><path d="M20 52 v20 M14 54 l6 6 M14 62 l6 6 M14 70 l6 6" />`}
      <path d="M135 6 v22 m-4 -6 4 6 4 -6" class="force" />
      <rect x="112" y="32" width="46" height="52" rx="3" class="part" />
      ${drawing.has_drive && html`<path d="M112 42 H158 M112 50 H158 M112 58 H158 M112 66 H158 M112 74 H158" class="thin" />
        <path d="M88 36 q4 -8 8 0 t8 0 M104 36 H112" class="wave" />`}
      <path d="M118 84 H152 V100 L144 112 H126 L118 100 Z" class="part is-pin" />
      <path d="M168 90 v22 m-3 -17 3 -5 3 5 m-6 12 3 5 3 -5" class="force" />
      <path d="M126 112 H144" class="contact" />
      <path d="M74 103 L122 111" class="thin" />
      <rect x="40" y="113" width="190" height="20" rx="3" class="part is-disc" />
      <path d="M96 150 H166 m-6 -4 6 4 -6 4" class="force" />
    </g>
    ${shown.map((field) => html`<${Value} key=${field.key} field=${field} text=${textOf(field)} />`)}
  </svg>`;
}
