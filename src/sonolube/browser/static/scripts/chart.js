/** Figures of the workbench: a chart of the server as panels in a grid, with legend, scale of colours and tables. */
import {html, useLayoutEffect, useMemo, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {TextTable} from './answer.js';
import {MARKERS, ownEnds} from './chart-draw.js';
import {categoryColour, ColourScale} from './chart-field.js';
import {ChartPanel, panelName} from './chart-panel.js';
import {dash, fieldOf, flat, rangesOf, themeOf} from './chart-scale.js';
import {classes, useEvents} from './parts.js';

const MIN_WIDTH = 250; // px of a panel
const [LOWEST, HIGHEST, WIDEST, TALLEST] = [180, 400, 760, 640]; // px
const GAP = 16;
const COLOURS_WIDTH = 72;
const TEXT_HEIGHT = 18; // of the label of an axis
const [BESIDE, BELOW] = [50, 38]; // px that numbers take beside and below a panel
const WORD_HEIGHT = 19; // px along y that a word takes
/**
 * @import {PartPoint} from './chart-draw.js'
 * @import {Scaled} from './chart-field.js'
 * @import {Drag, OnPick, Over} from './chart-panel.js'
 * @import {ChartData, Panel, Part, Ranges, Theme} from './chart-scale.js'
 * @typedef {{label: string, chart: ChartData}} Kept chart of an answer that was kept
 * @typedef {{title?: string, heads: string[], rows: string[][]}} ChartTable
 * @typedef {[string, Part]} Entry of a legend
 */
/** @type {Kept[]} */
const NO_KEPT = [];
/** @type {('x'|'y')[]} */
const AXES = ['x', 'y'];

/**
 * Width of an element and colours of its theme, followed while it is shown.
 * @returns {[import('../vendor/htm-preact-3.1.1.js').Ref<any>, number, Theme|null]}
 */
function useRoom() {
  const figure = useRef(null);
  const [width, setWidth] = useState(0);
  const [theme, setTheme] = useState(null);
  const paint = () => setTheme(themeOf(figure.current));
  useEvents(['themechange'], paint);
  useLayoutEffect(() => {
    const measure = () => {
      const {paddingLeft, paddingRight} = getComputedStyle(figure.current);
      setWidth(Math.floor(figure.current.clientWidth - parseFloat(paddingLeft) - parseFloat(paddingRight)));
    };
    measure();
    paint();
    const observer = new ResizeObserver(measure);
    observer.observe(figure.current);
    return () => observer.disconnect();
  }, []);
  return [figure, width, theme];
}

/**
 * Fields, or shaded points with a scale of their own, of a panel.
 * @param {Panel} panel
 * @returns {Scaled|null}
 */
function scaledOf(panel) {
  const field = fieldOf(panel);
  if (field) return field.words ? null : field;
  const shaded = panel.parts.find((part) => part.kind === 'points' && part.shades && part.scale_text);
  if (!shaded) return null;
  const [lowest, highest] = ownEnds(shaded);
  return {values: [[lowest, highest]], lowest, highest, scale: 'viridis', scale_text: shaded.scale_text};
}

/**
 * The scale that serves all panels; null where each has its own.
 * @param {ChartData} chart
 * @returns {Scaled|null}
 */
function commonScale(chart) {
  const [first, ...others] = chart.panels.filter((panel) => panel.parts.length).map(scaledOf);
  if (!first?.levels || !others.length) return null;
  /** @param {Scaled|null} field */
  const isSame = (field) => field?.scale_text === first.scale_text && String(field?.levels) === String(first.levels);
  return others.every(isSame) ? first : null;
}

/**
 * Labelled parts of some panels, and names of categories, each label once.
 * @param {Panel[]} panels
 * @returns {Entry[]}
 */
function entriesOf(panels) {
  /** @param {Part} part @returns {Entry[]} */
  const categories = ({words, values}) =>
    [...new Set(/** @type {number[][]} */ (values).flat())]
      .filter((value) => value !== null)
      .map((value) => [words[value], {kind: 'zone', colour: categoryColour(value), opacity: 1, isPlain: true}]);
  const entries = panels
    .flatMap((panel) => panel.parts)
    .flatMap((part) => {
      if (part.kind === 'field') return part.words ? categories(part) : [];
      if (!part.label || part.kind === 'note') return [];
      return [/** @type {Entry} */ ([part.label, part.shades ? {...part, colour: '#808080'} : part])];
    });
  return entries.filter(([label], at) => at === entries.findIndex(([other]) => other === label));
}

/** @param {{part: Part, theme: Theme}} props */
function Swatch({part, theme}) {
  const [stroke, fill] = [theme.stroke(part.colour), part.isPlain ? part.colour : theme.fill(part.colour)];
  const isFilled = part.kind === 'band' || part.kind === 'zone' || part.kind === 'bars';
  return html`<svg width="26" height="14" viewBox="0 0 26 14" aria-hidden="true">
    ${
      isFilled &&
      html`<rect
        x="2"
        y="2"
        width="22"
        height="10"
        fill=${part.kind === 'bars' ? stroke : fill}
        fill-opacity=${part.opacity ?? 1}
      />`
    }
    ${
      (part.kind === 'line' || part.kind === 'rule') &&
      html`<path
        d="M1 7H25"
        fill="none"
        stroke=${part.isKept ? theme.kept : stroke}
        stroke-width="2"
        stroke-dasharray=${dash(part.dash).join(' ')}
      />`
    }
    ${
      part.marker != null &&
      html`<path
        transform="translate(13 7) scale(4)"
        d=${MARKERS[part.marker % MARKERS.length]}
        fill=${part.is_hollow ? 'none' : stroke}
        stroke=${stroke}
        stroke-width=${part.is_hollow ? 0.35 : 0.1}
      />`
    }
  </svg>`;
}

/** @param {{entries: Entry[], theme: Theme, title?: string|null}} props */
const Legend = ({entries, theme, title}) =>
  entries.length
    ? html`<div class="chart-legend">
      ${title && html`<span class="chart-legend-title">${title}</span>`}
      <ul>
        ${entries.map(
          ([label, part]) => html`<li key=${label}><${Swatch} part=${part} theme=${theme} /><span>${label}</span></li>`,
        )}
      </ul>
    </div>`
    : null;

/**
 * Shares of columns or rows, equal ones where they are not given, and their sum.
 * @param {number[]|null|undefined} given
 * @param {number} count
 * @returns {[number[], number]}
 */
function sharesOf(given, count) {
  const shares = given?.length === count ? given : Array(count).fill(1);
  return [shares, shares.reduce((sum, share) => sum + share, 0)];
}

/**
 * Width and height of each panel in px, and the number of columns.
 * @param {ChartData} chart
 * @param {Ranges[]} ranges
 * @param {number} width
 * @param {(place: number) => boolean} isScaled
 */
function layoutOf({panels, columns: wanted, size: [inchWide, inchHigh], widths, heights}, ranges, width, isScaled) {
  const columns = Math.max(1, Math.min(wanted, Math.floor((width + GAP) / (MIN_WIDTH + GAP))));
  const isWhole = columns === wanted;
  const rows = Math.ceil(panels.length / wanted);
  const [wide, allWide] = sharesOf(isWhole ? widths : null, columns);
  const [high, allHigh] = sharesOf(heights, rows);
  const room = Math.min(width, WIDEST * columns) - GAP * (columns - 1);
  const aspect = inchHigh / rows / (inchWide / wanted);
  const base = Math.min(Math.max((room / columns) * aspect, LOWEST), HIGHEST);
  /** @param {number} place */
  const sizeOf = (place) => {
    const own = Math.floor((room * wide[place % columns]) / allWide - (isScaled(place) ? COLOURS_WIDTH : 0));
    const words = WORD_HEIGHT * (panels[place].y.words?.length ?? 0);
    const [across, up] = AXES.map((name) => Math.abs(ranges[place][name][1] - ranges[place][name][0]));
    if (panels[place].has_equal_scales) {
      const wide = Math.min(own - BESIDE, ((TALLEST - BELOW) * across) / up);
      return {width: Math.round(wide + BESIDE), height: Math.round((wide * up) / across + BELOW)};
    }
    const height = (base * high[Math.floor(place / wanted)] * rows) / allHigh;
    return {width: own, height: Math.round(Math.max(height, words))};
  };
  return {columns, isWhole, sizeOf};
}

/**
 * Numbers of a chart as tables, below it; the last ones, dim, where an answer has none since a slider moves.
 * @param {{tables?: ChartTable[], name: string}} props
 */
function ChartTables({tables: latest, name}) {
  const [isOpen, setOpen] = useState(false);
  const last = useRef(latest);
  if (latest) last.current = latest;
  const tables = last.current;
  if (!tables?.length) return null;
  return html`<details
    class=${classes('chart-numbers', {'is-dim': !latest})}
    onToggle=${(event) => setOpen(event.target.open)}
    data-test=${`numbers:${name}`}
  >
    <summary>Numbers</summary>
    ${
      isOpen &&
      tables.map(
        (table, at) => html`<${TextTable}
          key=${at}
          caption=${table.title || 'Numbers'}
          heads=${table.heads}
          rows=${table.rows}
          kind="chart-table"
          hasRowHeads=${false}
        />`,
      )
    }
  </details>`;
}

/**
 * @param {{name: string, caption?: string, chart: ChartData, tables?: ChartTable[], dimmed?: boolean, kept?: Kept[],
 *   onPick?: OnPick, canPick?: (panel: number) => boolean, picks?: string, onRead?: (point: PartPoint|null) => void,
 *   ringed?: {x: number, y: number}, drag?: Drag[], over?: Over}} props
 */
export function Chart({
  name,
  caption,
  chart,
  tables,
  dimmed,
  kept = NO_KEPT,
  onPick,
  canPick,
  picks,
  onRead,
  ringed,
  drag,
  over,
}) {
  const [figure, width, theme] = useRoom();
  const [said, say] = useState('');
  const keptCharts = useMemo(() => kept.map((each) => each.chart), [kept]);
  const ranges = useMemo(() => rangesOf(chart, keptCharts), [chart, keptCharts]);
  const behind = useMemo(
    () =>
      chart.panels.map((_, place) =>
        keptCharts
          .map((each) => (each.panels[place]?.parts ?? []).find((part) => part.kind === 'line'))
          .filter(Boolean),
      ),
    [chart, keptCharts],
  );
  const common = useMemo(() => commonScale(chart), [chart]);
  /** @param {number} place */
  const isScaled = (place) => !common && Boolean(scaledOf(chart.panels[place]));
  const room = width - (common ? COLOURS_WIDTH : 0);
  const layout = width && theme ? layoutOf(chart, ranges, room, isScaled) : null;
  const {legend} = chart;
  const keptEntries = kept.map((each, place) => [
    `kept: ${each.label}`,
    {kind: 'line', colour: '#808080', dash: place, isKept: true},
  ]);
  const {title} = chart;
  const label = caption || title?.replaceAll('\n', ', ') || panelName(chart.panels[0]);
  /** @param {number} place */
  const hasXText = (place) =>
    !chart.shares_x || !layout?.isWhole || !chart.panels[place + layout.columns]?.parts.length;

  return html`<figure
    ref=${figure}
    class=${classes('chart', {'is-dimmed': dimmed})}
    aria-label=${label}
    data-test=${`chart:${name}`}
  >
    ${
      title &&
      html`<p class="chart-title">
        ${title.split('\n').map((row, place) => html`<span key=${place}>${row}</span>`)}
      </p>`
    }
    ${
      layout &&
      html`<${Legend}
        theme=${theme}
        title=${legend === 'panels' ? null : chart.legend_title}
        entries=${[...(legend === 'panels' || legend === 'none' ? [] : entriesOf(chart.panels)), ...keptEntries]}
      />`
    }
    <div class="chart-row">
      <div
        class="chart-grid"
        style=${layout ? {gridTemplateColumns: `repeat(${layout.columns}, max-content)`, gap: `${GAP}px`} : {}}
      >
        ${
          layout &&
          chart.panels.map((panel, place) => {
            if (!panel.parts.length) return html`<div key=${place}></div>`;
            const size = layout.sizeOf(place);
            const field = isScaled(place) ? scaledOf(panel) : null;
            return html`<div
              key=${place}
              class="chart-panel"
              style=${{width: `${size.width + (field ? COLOURS_WIDTH : 0)}px`}}
            >
              ${panel.title && html`<p class="chart-panel-title">${panel.title}</p>`}
              <p class="chart-y" aria-hidden="true">${flat(panel.y.text)}</p>
              ${legend === 'panels' && html`<${Legend} theme=${theme} entries=${entriesOf([panel])} />`}
              <div class="chart-row">
                <${ChartPanel}
                  panel=${panel}
                  place=${place}
                  ranges=${ranges[place]}
                  behind=${behind[place]}
                  width=${size.width}
                  height=${size.height + (hasXText(place) ? TEXT_HEIGHT : 0)}
                  hasXText=${hasXText(place)}
                  theme=${theme}
                  drag=${drag?.find((each) => each.panel === place)}
                  over=${over}
                  onPick=${!canPick || canPick(place) ? onPick : undefined}
                  picks=${picks}
                  onRead=${onRead}
                  ringed=${ringed}
                  say=${say}
                />
                ${field && html`<${ColourScale} field=${field} height=${size.height - 20} />`}
              </div>
            </div>`;
          })
        }
      </div>
      ${layout && common && html`<${ColourScale} field=${common} height=${Math.min(layout.sizeOf(0).height, 320)} />`}
    </div>
    <p class="hidden" role="status" aria-live="polite">${said}</p>
    ${caption && html`<figcaption>${caption}</figcaption>`}
    <${ChartTables} tables=${tables} name=${name} />
  </figure>`;
}
