/** Heights of a scan in 3D, the vertical stretched by a number that is shown. */
import {html, useMemo} from '../../vendor/htm-preact-3.1.1.js';
import {SurfaceView} from '../surface-view.js';
import {Choice} from './measured.js';

/** @typedef {import('../chart-field.js').FieldPart & {lowest: number, highest: number}} Heights */

const STRETCHES = [0, 1, 2, 3, 4, 5].flatMap((power) => [1, 2, 5].map((step) => step * 10 ** power));
const SHARE = 0.15; // of the longer side that the heights take, where no other stretch is chosen
const NAMES = ['x', '−y', 'z']; // y runs down the map, away from what is drawn at the top

/**
 * Stretch that shows heights well.
 * @param {Heights} map
 * @param {number} ratio
 */
function usualStretch({x, y, lowest, highest}, ratio) {
  const longer = Math.max(...[x, y].map((axis) => axis[axis.length - 1] - axis[0]));
  const wanted = (SHARE * longer) / ((highest - lowest) * ratio || 1);
  return STRETCHES.findLast((each) => each <= wanted) ?? STRETCHES[0];
}

/**
 * Vertices and triangles of the cells of a map, without those that were not measured.
 * @param {Heights} map
 * @param {number} scale
 */
function meshOf({x, y, values, lowest, highest}, scale) {
  const count = x.length;
  const heights = Float32Array.from(values.flat(), (value) => value ?? NaN);
  const positions = new Float32Array(3 * heights.length);
  heights.forEach((height, at) =>
    positions.set(
      [x[at % count], -y[Math.floor(at / count)], scale * (Number.isNaN(height) ? lowest : height)],
      3 * at,
    ),
  );
  const triangles = [];
  for (let at = 0; at < heights.length - count; at += 1) {
    if (at % count === count - 1) continue;
    for (const corners of [
      [at, at + count, at + 1],
      [at + 1, at + count, at + count + 1],
    ]) {
      if (corners.every((corner) => !Number.isNaN(heights[corner]))) triangles.push(...corners);
    }
  }
  // lowest where it is not known
  const shades = heights.map((height) => (height > lowest ? Math.min(height, highest) : lowest));
  return {positions, triangles: new Uint32Array(triangles), values: shades};
}

/**
 * @param {{content: any, own: import('./files.js').Own, set: import('./files.js').SetOwn, label: string}} props
 *   `content` as of the view `scan`
 */
export function Relief({content, own, set, label}) {
  const [field] = content.chart.panels[0].parts;
  const ratio = content.metres.height / content.metres.across;
  const usual = usualStretch(field, ratio);
  const stretch = Number(own.stretch ?? usual);
  const mesh = useMemo(() => meshOf(field, ratio * stretch), [content, stretch]);
  const choices = STRETCHES.map((each) => [
    String(each),
    each === 1 ? 'to scale' : `${each} times as high as they are`,
  ]);
  return html`
    <div class="scan-stretch">
      <${Choice}
        name="stretch"
        label="Heights are drawn"
        choices=${choices}
        value=${String(stretch)}
        onValue=${(value) => set({stretch: Number(value) === usual ? null : value})}
      />
    </div>
    <${SurfaceView}
      ...${mesh}
      names=${NAMES}
      hasEdges=${false}
      scale="cividis"
      quantity="Height"
      unit=${field.unit}
      label=${`${label}, heights drawn ${stretch} times as high as they are`}
    />
  `;
}
