/**
 * A scan of a surface: its heights as map and relief, a section, and what is measured of it: roughness or wear grooves.
 */
import {html, useMemo, useRef} from '../../vendor/htm-preact-3.1.1.js';
import {Failure, TextTable} from '../answer.js';
import {useReply} from '../api.js';
import {Chart} from '../chart.js';
import {along} from '../chart-scale.js';
import {Waiting} from '../job.js';
import {Button, Card, classes, Loading} from '../parts.js';
import {settle} from '../state.js';
import {save} from '../take-away.js';
import {Choice, countsTo, Measured, Settings, stated} from './measured.js';
import {Relief} from './relief.js';

/**
 * @import {Name, Panel, Ranges} from '../chart-scale.js'
 * @import {DataFile, FileProps, Own, SetOwn} from './files.js'
 * @typedef {Record<string, string>} Section its ends with their units
 */

const LACKING = [
  ['spacing', 'Distance of pixels, or x,y', 'such as 0.5 um'],
  ['length_unit', 'Unit of the lengths', 'such as um'],
];
const HEIGHTS = [
  ['levelled', 'without the form'],
  ['measured', 'as measured'],
  ['form', 'the form alone'],
];
const FORMS = [
  ['0', 'mean'],
  ['1', 'plane'],
  ['2', 'plane and curvature'],
  ['3', 'of degree 3'],
  ['4', 'of degree 4'],
];
const VIEWS = [
  ['map', 'map'],
  ['relief', 'in 3D'],
];
/**
 * Tasks that measure a scan, each with its title and settings.
 * @type {Record<string, {title: string, fields: string[][]}>}
 */
const TASKS = {
  surface: {
    title: 'roughness',
    fields: [
      ['short_cutoff', 'Remove waves below'],
      ['long_cutoff', 'Remove waves above'],
    ],
  },
  groove: {
    title: 'wear grooves',
    fields: [
      ['groove_diameter', 'Diameter of the ring', 'unknown'],
      ['sliding_distance', 'Sliding distance', 'unknown'],
      ['tip_radius', 'Radius of the pin', 'unknown'],
    ],
  },
};
/** @type {Name[]} */
const AXES = ['x', 'y'];
const ENDS = [
  ['from', 'Beginning'],
  ['to', 'End'],
];
const SECTION = [
  ['from_x', 'From x'],
  ['from_y', 'From y'],
  ['to_x', 'To x'],
  ['to_y', 'To y'],
];
const MAX_TRACKS = 6;
const STEPS = 200; // of the arrow keys over a side of the map
const RIG_NOTE =
  'Summits at the pixels as they are; the table by sampling interval says how far they depend on it. ' +
  'One surface against a smooth one.';
/** @type {Record<string, number[]>} */
const KEYS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};

/** @param {Own} own */
const isCut = (own) => Boolean(own.short_cutoff || own.long_cutoff);
/** @param {Own} own */
const degreeOf = (own) => Number(own.degree ?? 1);

/**
 * What measures a scan.
 * @param {DataFile} file
 * @param {Own} own
 * @returns {import('./files.js').Asked}
 */
export function taskOf(file, own) {
  const name = own.measure ?? 'surface';
  const texts = [...LACKING, ...TASKS[name].fields].map(([entry]) => [entry, own[entry]]);
  const more = name === 'surface' ? {form: degreeOf(own), robust: own.robust} : {track: own.track && Number(own.track)};
  return {task: `measure ${name}`, args: {files: file, ...stated({...more, ...Object.fromEntries(texts)})}};
}

/** @param {number} value @param {string} unit */
const textIn = (value, unit) => `${Number(value.toPrecision(5))} ${unit}`;

/**
 * Field of a map: cells with their places.
 * @param {any} content
 * @returns {import('../chart-field.js').FieldPart}
 */
const fieldOf = (content) => content.chart.panels[0].parts[0];

/**
 * Ends of the section, by default along x through the middle of the map.
 * @param {any} content
 * @param {Own} own
 * @returns {Section}
 */
function sectionOf(content, own) {
  const {x, y} = fieldOf(content);
  const {unit} = content.chart.panels[0].x;
  const middle = textIn(y[Math.floor(y.length / 2)], unit);
  return {
    from_x: textIn(x[0], unit),
    from_y: middle,
    to_x: textIn(x[x.length - 1], unit),
    to_y: middle,
    ...stated(own.section ?? {}),
  };
}

/**
 * Numbers of the ends of the section in the unit of the map; null where one is written in another.
 * @param {Section} section
 * @param {string} unit
 * @returns {number[]|null}
 */
function placesOf(section, unit) {
  const numbers = SECTION.map(([name]) =>
    section[name].endsWith(unit) || section[name].endsWith(unit.replace('µ', 'u')) ? parseFloat(section[name]) : NaN,
  );
  return numbers.every(Number.isFinite) ? numbers : null;
}

/**
 * End of a section on the map, moved by pointer and arrow keys.
 * @param {{label: string, place: number[], panel: Panel, ranges: Ranges, onMove: (place: number[]) => void}} props
 */
function End({label, place, panel, ranges, onMove}) {
  const held = useRef(false);
  const axes = AXES.map((name) => along(panel[name], ranges[name]));
  const shares = axes.map((axis, at) => axis.to(place[at]));
  /** @param {number[]} next */
  const to = (next) => onMove(axes.map((axis, at) => axis.back(Math.min(Math.max(next[at], 0), 1))));
  /** @param {PointerEvent & {currentTarget: Element}} event */
  const move = (event) => {
    if (!held.current) return;
    const map = /** @type {Element} */ (event.currentTarget.parentElement);
    const {left, top, width, height} = map.getBoundingClientRect();
    to([(event.clientX - left) / width, 1 - (event.clientY - top) / height]);
  };
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    const step = KEYS[event.key];
    if (!step) return;
    event.preventDefault();
    to(shares.map((share, at) => share + (step[at] * (event.shiftKey ? 10 : 1)) / STEPS));
  };
  /** @param {PointerEvent & {currentTarget: Element}} event */
  const hold = (event) => {
    held.current = true;
    event.currentTarget.setPointerCapture(event.pointerId);
  };
  const leave = () => {
    held.current = false;
    settle();
  };
  const said = place.map((value, at) => `${'xy'[at]} ${textIn(value, panel.x.unit ?? '')}`).join(', ');
  return html`<button
    type="button"
    class="scan-end"
    style=${{left: `${100 * shares[0]}%`, top: `${100 * (1 - shares[1])}%`}}
    onPointerDown=${hold}
    onPointerMove=${move}
    onPointerUp=${leave}
    onPointerCancel=${leave}
    onKeyDown=${press}
    onBlur=${settle}
    data-test=${`end:${label}`}
    aria-label=${`${label} of the section: ${said}. Arrow keys move it, with shift ten times as far.`}
  ></button>`;
}

/**
 * Map with the section on it.
 * @param {{content: any, section: Section, set: SetOwn}} props
 */
function HeightMap({content, section, set}) {
  const [panel] = content.chart.panels;
  const {x, y} = fieldOf(content);
  const places = placesOf(section, panel.x.unit);
  const chart = useMemo(() => {
    const line = places && {
      kind: 'line',
      x: [places[0], places[2]],
      y: [places[1], places[3]],
      label: 'section',
      colour: '#000000',
      weight: 1,
      has_halo: true,
    };
    return {...content.chart, legend: 'none', panels: [{...panel, parts: [fieldOf(content), ...(line ? [line] : [])]}]};
  }, [content, String(places)]);
  /** @param {string} name @returns {(next: number[]) => void} */
  const move = (name) => (next) => {
    const within = [x, y].map((axis, at) => Math.min(Math.max(next[at], axis[0]), axis[axis.length - 1]));
    set(
      {
        section: {
          ...section,
          [`${name}_x`]: textIn(within[0], panel.x.unit),
          [`${name}_y`]: textIn(within[1], panel.x.unit),
        },
      },
      {replace: true},
    );
  };
  /** @param {Panel} shown @param {Ranges} ranges */
  const over = (shown, ranges) =>
    places &&
    ENDS.map(
      ([name, label], at) => html`<${End}
        key=${name}
        label=${label}
        panel=${shown}
        ranges=${ranges}
        place=${places.slice(2 * at, 2 * at + 2)}
        onMove=${move(name)}
      />`,
    );
  return html`<${Chart}
    name="map"
    chart=${chart}
    caption="Heights; the section runs between its two ends, which can be dragged."
    over=${over}
  />`;
}

/**
 * Section of a scan with its ends as numbers.
 * @param {{file: DataFile, request: object, section: Section, set: SetOwn}} props
 */
function SectionCard({file, request, section, set}) {
  const {content, failure, isWaiting} = useReply(`section ${file.upload}`, 'api/section', {...request, section});
  const take = () => {
    const [panel] = content.chart.panels;
    const [{x, y}] = panel.parts;
    const rows = /** @type {number[]} */ (x).map((value, at) => `${value},${y[at] ?? ''}`);
    save({
      name: 'section.csv',
      kind: 'text/csv',
      text: `# ${content.note}\n${panel.x.text},${panel.y.text}\n${rows.join('\n')}\n`,
    });
  };
  return html`<${Card} id="section-title" title="Section" data-test="section">
    <${Settings}
      fields=${SECTION}
      own=${section}
      set=${(partial) => set({section: {...section, ...partial}})}
      faults=${failure?.faults}
    />
    <${Failure} failure=${failure} shown=${SECTION.map(([name]) => name)} />
    ${!content && !failure && html`<${Loading}>Cutting…<//>`}
    ${
      content &&
      html`<div aria-busy=${isWaiting}>
        <${Chart} name="section" chart=${content.chart} dimmed=${Boolean(failure)} />
        <${TextTable} rows=${content.facts} label="The section" />
        <p><${Button} onClick=${take} data-test="take-section">Save as CSV<//></p>
      </div>`
    }
  <//>`;
}

/** @param {FileProps} props */
export default function Scan({file, own, set}) {
  const {shown = 'levelled', robust = false, seen = 'map', measure = 'surface'} = own;
  const request = {
    file,
    shown,
    degree: degreeOf(own),
    robust,
    ...stated({spacing: own.spacing, length_unit: own.length_unit}),
  };
  const {content, failure, isWaiting} = useReply(`scan ${file.upload}`, 'api/scan', request);
  const lacking = LACKING.filter(([name]) => own[name] || failure?.faults.some(({key}) => key === name));
  const section = content && !content.is_profile && sectionOf(content, own);
  /** @param {string} name @param {string} usual @returns {(value: string) => void} */
  const pick = (name, usual) => (value) => set({[name]: value === usual ? null : value});
  /** @type {string[]} */
  const caveats = content?.caveats ?? [];
  return html`
    <div class=${classes('scan-columns', {'is-alone': !section})}>
      <${Card} id="scan-title" title=${file.name}>
        <div class="row scan-row">
          <${Choice}
            name="shown"
            label="Heights"
            choices=${HEIGHTS}
            value=${shown}
            onValue=${pick('shown', 'levelled')}
          />
          <${Choice}
            name="degree"
            label="Form"
            choices=${FORMS}
            value=${String(degreeOf(own))}
            onValue=${pick('degree', '1')}
          />
          ${
            section &&
            html`<${Choice}
              name="seen"
              label="Shown as"
              choices=${VIEWS}
              value=${seen}
              onValue=${pick('seen', 'map')}
            />`
          }
          <label class="check">
            <input
              type="checkbox"
              checked=${robust}
              onChange=${(event) => set({robust: event.target.checked || null})}
              data-test="set:robust"
            />
            <span>Fit the form past grooves</span>
          </label>
        </div>
        ${lacking.length > 0 && html`<${Settings} fields=${lacking} own=${own} set=${set} faults=${failure?.faults} />`}
        <${Failure} failure=${failure} shown=${LACKING.map(([name]) => name)} />
        ${!content && !failure && html`<${Loading}>Reading ${file.name}… <${Waiting} isWaiting=${isWaiting} /><//>`}
        ${
          content &&
          html`<div aria-busy=${isWaiting} data-test="scan">
            ${
              !section
                ? html`<${Chart} name="profile" chart=${content.chart} caption="Heights along the profile." />`
                : seen === 'relief'
                  ? html`<${Relief} content=${content} own=${own} set=${set} label=${`${file.name} in 3D`} />`
                  : html`<${HeightMap} content=${content} section=${section} set=${set} />`
            }
            ${caveats.map((line) => html`<p key=${line} class="notice">${line}</p>`)}
            <details class="chart-numbers">
              <summary>About this scan</summary>
              <${TextTable} rows=${content.facts} label="About this scan" />
            </details>
          </div>`
        }
      <//>
      ${section && html`<${SectionCard} file=${file} request=${request} section=${section} set=${set} />`}
    </div>
    ${
      content &&
      html`<${Card} id="measure-title" title="Measured">
        <div class="row scan-row">
          <${Choice}
            name="measure"
            label="Measure"
            choices=${Object.entries(TASKS).map(([name, {title}]) => [name, title])}
            value=${measure}
            onValue=${pick('measure', 'surface')}
          />
          ${
            measure === 'groove' &&
            html`<${Choice}
              name="track"
              label="Track"
              choices=${countsTo('the only one', MAX_TRACKS)}
              value=${own.track ?? ''}
              onValue=${pick('track', '')}
            />`
          }
        </div>
        <${Measured}
          key=${measure}
          file=${file}
          asked=${taskOf(file, own)}
          fields=${TASKS[measure].fields}
          own=${own}
          set=${set}
          rigNote=${RIG_NOTE}
          leave=${measure === 'surface' && !isCut(own) && section ? ['Heights'] : []}
        />
      <//>`
    }
  `;
}
