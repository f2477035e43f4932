/**
 * Figures of the workbench: a chart of the server as panels in a grid, with legend, scale of colours and tables.
 */
import {html, useLayoutEffect, useMemo, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {TextTable} from './answer.js';
import {MARKERS, ownScale} from './chart-draw.js';
import {categoryColour, ColourScale} from './chart-field.js';
import {ChartPanel, panelName} from './chart-panel.js';
import {dash, rangesOf, themeOf} from './chart-scale.js';

const MIN_WIDTH = 250; // px of a panel
const [LOWEST, HIGHEST, WIDEST] = [180, 400, 760]; // px
const GAP = 16;
const COLOURS_WIDTH = 72;
const TEXT_HEIGHT = 18; // of the label of an axis
const [BESIDE, BELOW] = [50, 38]; // px that numbers take beside and below a panel
const WORD_HEIGHT = 19; // px along y that a word takes
const NO_KEPT = [];

/** Width of an element and colours of its theme, followed while it is shown. */
function useRoom() {
  const figure = useRef(null);
  const [room, setRoom] = useState({width: 0, theme: null});
  useLayoutEffect(() => {
    const element = figure.current;
    const measure = () => setRoom((old) => {
      const {paddingLeft, paddingRight} = getComputedStyle(element);
      const width = Math.floor(element.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight));
      return old.theme && old.width === width ? old : {theme: old.theme ?? themeOf(element), width};
    });
    const paint = () => setRoom((old) => ({...old, theme: themeOf(element)}));
    measure();
    const observer = new ResizeObserver(measure);
    observer.observe(element);
    const dark = matchMedia('(prefers-color-scheme: dark)');
    addEventListener('themechange', paint);
    dark.addEventListener('change', paint);
    return () => {
      observer.disconnect();
      removeEventListener('themechange', paint);
      dark.removeEventListener('change', paint);
    };
  }, []);
  return [figure, room];
}

/** Fields, or shaded points with a scale of their own, of a panel. */
function scaledOf(panel) {
  const field = panel.parts.find((part) => part.kind === 'field');
  if (field) return field.words ? null : field;
  const shaded = panel.parts.find((part) => part.kind === 'points' && part.shades && part.scale_text);
  if (!shaded) return null;
  const [lowest, highest] = ownScale(shaded).ends;
  return {values: [[lowest, highest]], lowest, highest, scale: 'viridis', scale_text: shaded.scale_text};
}

/** The scale that serves all panels; null where each has its own. */
function commonScale(chart) {
  const fields = chart.panels.filter((panel) => panel.parts.length).map(scaledOf);
  const [first] = fields;
  const isCommon = fields.length > 1 && fields.every((field) => field?.levels && field.scale_text === first.scale_text
    && String(field.levels) === String(first.levels));
  return isCommon ? first : null;
}

/** Labelled parts of some panels, each label once. */
function entriesOf(panels) {
  const found = new Map();
  for (const panel of panels) {
    for (const part of panel.parts) {
      if (part.kind === 'field' && part.words) {
        for (const number of new Set(part.values.flat().filter((value) => value !== null))) {
          found.set(part.words[number], {kind: 'zone', colour: categoryColour(number), opacity: 1, isPlain: true});
        }
      } else if (part.label && part.kind !== 'field' && part.kind !== 'note' && !found.has(part.label)) {
        found.set(part.label, part.shades ? {...part, colour: '#808080'} : part);
      }
    }
  }
  return [...found];
}

function Swatch({part, theme}) {
  const [stroke, fill] = [theme.stroke(part.colour), part.isPlain ? part.colour : theme.fill(part.colour)];
  const isFilled = part.kind === 'band' || part.kind === 'zone' || part.kind === 'bars';
  const mark = part.kind === 'points' ? part.marker ?? 0 : part.marker;
  return html`<svg width="26" height="14" viewBox="0 0 26 14" aria-hidden="true">
    ${isFilled && html`<rect x="2" y="2" width="22" height="10" fill=${part.kind === 'bars' ? stroke : fill} fill-opacity=${part.opacity ?? (part.kind === 'band' ? 0.25 : 1)} />`}
    ${(part.kind === 'line' || part.kind === 'rule') && html`<path d="M1 7H25" fill="none" stroke=${part.isKept ? theme.kept : stroke} stroke-width="2"
      stroke-dasharray=${dash(part.dash ?? (part.kind === 'rule' ? 3 : 0)).join(' ')} />`}
    ${mark != null && html`<path transform="translate(13 7) scale(4)" d=${MARKERS[mark % MARKERS.length]} fill=${part.is_hollow ? 'none' : stroke}
      stroke=${stroke} stroke-width=${part.is_hollow ? 0.35 : 0.1} />`}
  </svg>`;
}

const Legend = ({entries, theme, title}) => (entries.length ? html`<div class="chart-legend">
  ${title && html`<span class="chart-legend-title">${title}</span>`}
  <ul>${entries.map(([label, part]) => html`<li key=${label}><${Swatch} part=${part} theme=${theme} /><span>${label}</span></li>`)}</ul>
</div>` : null);

/** Width and height of each panel in px, and the number of columns. */
function layoutOf(chart, ranges, width, isScaled) {
  const columns = Math.max(1, Math.min(chart.columns ?? 1, Math.floor((width + GAP) / (MIN_WIDTH + GAP))));
  const isWhole = columns === (chart.columns ?? 1);
  const rows = Math.ceil(chart.panels.length / (chart.columns ?? 1));
  const [inchWide, inchHigh] = chart.size ?? [5.2, 3.6];
  const shares = isWhole && chart.widths?.length === columns ? chart.widths : Array(columns).fill(1);
  const whole = shares.reduce((sum, share) => sum + share, 0);
  const room = Math.min(width, WIDEST * columns) - GAP * (columns - 1);
  const heights = chart.heights?.length === rows ? chart.heights : Array(rows).fill(1);
  const mean = heights.reduce((sum, share) => sum + share, 0) / rows;
  const aspect = (inchHigh / rows) / (inchWide / (chart.columns ?? 1));
  return {
    columns, isWhole, size: (place) => {
      const full = (room * shares[place % columns]) / whole;
      const base = Math.min(Math.max((room / columns) * aspect, LOWEST), HIGHEST);
      const own = heights[Math.floor(place / (chart.columns ?? 1))] / mean;
      const words = WORD_HEIGHT * (chart.panels[place].y.words?.length ?? 0);
      const wide = Math.floor(full - (isScaled(place) ? COLOURS_WIDTH : 0));
      const [across, up] = ['x', 'y'].map((name) => Math.abs(ranges[place][name][1] - ranges[place][name][0]));
      const isEqual = chart.panels[place].has_equal_scales;
      const high = isEqual ? Math.min(((wide - BESIDE) * up) / across + BELOW, WIDEST) : base * own;
      return {width: wide, height: Math.round(Math.max(high, words))};
    },
  };
}

/** Numbers of a chart as tables, below it. */
function ChartTables({tables, name}) {
  const [isOpen, setOpen] = useState(false);
  if (!tables?.length) return null;
  return html`<details class="chart-numbers" onToggle=${(event) => setOpen(event.target.open)} data-test=${`numbers:${name}`}>
    <summary>Numbers</summary>
    ${isOpen && tables.map((table, at) => html`<${TextTable} key=${at} caption=${table.title || 'Numbers'}
      heads=${table.heads} rows=${table.rows} kind="chart-table" hasRowHeads=${false} />`)}
  </details>`;
}

/**
 * @param {{name: string, caption?: string, chart: Object, tables?: Object[], dimmed?: boolean,
 *   kept?: {label: string, chart: Object}[], onPick?: (place: {panel: number, x: number, y: number}) => void,
 *   canPick?: (panel: number) => boolean,
 *   drag?: {panel: number, onMove: (x: number) => void, onRelease: (x: number) => void}|Object[]}} props
 */
export function Chart({name, caption, chart, tables, dimmed, kept = NO_KEPT, onPick, canPick, drag}) {
  const [figure, {width, theme}] = useRoom();
  const [said, say] = useState('');
  const keptCharts = useMemo(() => kept.map((each) => each.chart), [kept]);
  const ranges = useMemo(() => rangesOf(chart, keptCharts), [chart, keptCharts]);
  const behind = useMemo(() => chart.panels.map((_, place) => keptCharts.map((each) => (each.panels[place]?.parts ?? [])
    .find((part) => part.kind === 'line')).filter(Boolean)), [chart, keptCharts]);
  const common = useMemo(() => commonScale(chart), [chart]);
  const isScaled = (place) => !common && Boolean(scaledOf(chart.panels[place]));
  const draggable = Array.isArray(drag) ? drag : drag ? [drag] : [];
  const room = width - (common ? COLOURS_WIDTH : 0);
  const layout = width && theme ? layoutOf(chart, ranges, room, isScaled) : null;
  const legend = chart.legend ?? 'panels';
  const keptEntries = kept.map((each, place) => [`kept: ${each.label}`, {kind: 'line', colour: '#808080', dash: place, isKept: true}]);
  const label = caption || chart.title?.replaceAll('\n', ', ') || panelName(chart.panels[0]);
  const hasXText = (place) => !chart.shares_x || !layout.isWhole || !chart.panels[place + layout.columns]?.parts.length;

  return html`<figure ref=${figure} class=${`chart${dimmed ? ' is-dimmed' : ''}`} aria-label=${label} data-test=${`chart:${name}`}>
    ${chart.title && html`<p class="chart-title">${chart.title.split('\n').map((row, place) => html`<span key=${place}>${row}</span>`)}</p>`}
    ${layout && legend !== 'panels' && html`<${Legend} theme=${theme} title=${chart.legend_title}
      entries=${[...(legend === 'none' ? [] : entriesOf(chart.panels)), ...keptEntries]} />`}
    ${layout && legend === 'panels' && html`<${Legend} theme=${theme} entries=${keptEntries} />`}
    <div class="chart-row">
      <div class="chart-grid" style=${layout ? {gridTemplateColumns: `repeat(${layout.columns}, max-content)`, gap: `${GAP}px`} : {}}>
        ${layout && chart.panels.map((panel, place) => {
          if (!panel.parts.length) return html`<div key=${place}></div>`;
          const size = layout.size(place);
          const field = isScaled(place) ? scaledOf(panel) : null;
          return html`<div key=${place} class="chart-panel" style=${{width: `${size.width + (field ? COLOURS_WIDTH : 0)}px`}}>
            ${panel.title && html`<p class="chart-panel-title">${panel.title}</p>`}
            <p class="chart-y" aria-hidden="true">${panel.y.text.replaceAll('\n', ' ')}</p>
            ${legend === 'panels' && html`<${Legend} theme=${theme} entries=${entriesOf([panel])} />`}
            <div class="chart-row">
              <${ChartPanel} panel=${panel} place=${place} ranges=${ranges[place]} behind=${behind[place]} width=${size.width}
                height=${size.height + (hasXText(place) ? TEXT_HEIGHT : 0)} hasXText=${hasXText(place)} theme=${theme} drag=${draggable.find((each) => each.panel === place)} onPick=${!canPick || canPick(place) ? onPick : undefined} say=${say} />
              ${field && html`<${ColourScale} field=${field} height=${size.height - 20} />`}
            </div></div>`;
        })}
      </div>
      ${layout && common && html`<${ColourScale} field=${common} height=${Math.min(layout.size(0).height, 320)} />`}
    </div>
    <p class="hidden" role="status" aria-live="polite">${said}</p>
    ${caption && html`<figcaption>${caption}</figcaption>`}
    <${ChartTables} tables=${tables} name=${name} />
  </figure>`;
}
