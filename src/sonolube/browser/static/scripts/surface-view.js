/**
 * Surfaces of bodies in WebGL2: coloured by a value, moved along a shape, turned by pointer and keys; and the controls
 * of the motion.
 */
import {html, useEffect, useLayoutEffect, useMemo, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ColourScale, colourAt} from './chart-field.js';
import {extent, rgb} from './chart-scale.js';
import {Button, useEvents} from './parts.js';

const VERTEX = `#version 300 es
  uniform mat3 rows; uniform vec3 middle; uniform vec2 scale; uniform float motion, reach; uniform vec2 ends;
  uniform bool isEdge;
  in vec3 position, shape; in float value;
  out vec3 seen; out float share;
  void main() {
    seen = rows * (position + motion * shape - middle);
    share = (value - ends.x) / (ends.y - ends.x);
    gl_Position = vec4(seen.xy * scale, -seen.z / reach - (isEdge ? 0.004 : 0.0), 1.0); // edges before their faces
  }`;
const FRAGMENT = `#version 300 es
  precision highp float;
  uniform sampler2D colours; uniform vec3 ink; uniform bool isEdge;
  in vec3 seen; in float share;
  out vec4 colour;
  void main() {
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    float light = 0.72 + 0.28 * abs(dot(normal, vec3(-0.3, 0.5, 0.81)));
    vec3 body = texture(colours, vec2(share, 0.5)).rgb * light;
    float rim = smoothstep(0.22, 0.04, abs(normal.z));
    colour = vec4(isEdge ? ink : mix(body, ink, rim), 1.0);
  }`;
/**
 * @import {FieldEvent} from './parts.js'
 * @typedef {Float32Array|number[]} Numbers
 * @typedef {{turn: number, tilt: number, size: number}} View
 * @typedef {NonNullable<ReturnType<typeof painterOn>>} Painter
 * @typedef {{positions: Float32Array, triangles: Uint32Array, values: Float32Array, shape?: Float32Array, amplitude?:
 *   number, phase?: number, label: string, quantity: string, unit: string, scale?: 'viridis'|'cividis'|'grey', names?:
 *   string[], hasEdges?: boolean, test?: string}} SurfaceProps `positions` and `shape` have three numbers a vertex;
 *   `label` names the picture, `quantity` what its colours are, `names` the axes
 */

const SHADES = 256;
const AXES = ['x', 'y', 'z'];
const SHARP = Math.cos(Math.PI / 6); // of the angle between triangles, above which their edge is drawn
const FIRST = {turn: (32 * Math.PI) / 180, tilt: (24 * Math.PI) / 180, size: 1};
const SLENDER = 1.5; // height over the other sides, above which a body is laid down
const [STEP, ZOOM, NEAREST, FARTHEST] = [Math.PI / 24, 1.2, 20, 0.3];
const PER_PIXEL = 0.009; // radians
const FILL = 0.94; // of the canvas by a body whichever way it is turned

document.head.append(
  Object.assign(document.createElement('link'), {rel: 'stylesheet', href: 'static/pages/surface-view.css'}),
); // once, with this module

/**
 * Steps of the view by keys, each with its sign on a button and its name.
 * @type {Record<string, [(view: View) => View, string, string]>}
 */
const STEPS = {
  ArrowLeft: [(view) => ({...view, turn: view.turn - STEP}), '←', 'Turn to the left'],
  ArrowRight: [(view) => ({...view, turn: view.turn + STEP}), '→', 'Turn to the right'],
  ArrowUp: [(view) => ({...view, tilt: view.tilt - STEP}), '↑', 'Tilt back'],
  ArrowDown: [(view) => ({...view, tilt: view.tilt + STEP}), '↓', 'Tilt forward'],
  '+': [(view) => sized(view, ZOOM), '+', 'Larger'],
  '-': [(view) => sized(view, 1 / ZOOM), '−', 'Smaller'],
  Home: [() => FIRST, '⌂', 'First view'],
};
/** @param {View} view @param {number} by @returns {View} */
const sized = (view, by) => ({...view, size: Math.min(Math.max(view.size * by, FARTHEST), NEAREST)});

/**
 * Lowest and highest coordinates, their middle and the sides between them.
 * @param {Float32Array} positions
 */
function boxOf(positions) {
  const [low, high] = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  for (let at = 0; at < positions.length; at += 1) {
    low[at % 3] = Math.min(low[at % 3], positions[at]);
    high[at % 3] = Math.max(high[at % 3], positions[at]);
  }
  return {middle: low.map((each, axis) => (each + high[axis]) / 2), sides: high.map((each, axis) => each - low[axis])};
}

/**
 * Length of the longest vector.
 * @param {Numbers} vectors
 */
function largestOf(vectors) {
  let most = 0;
  for (let at = 0; at < vectors.length; at += 3)
    most = Math.max(most, Math.hypot(vectors[at], vectors[at + 1], vectors[at + 2]));
  return most;
}

/**
 * Rows to the right, upwards and to the viewer; slender bodies lie, others stand on their z.
 * @param {View} view
 * @param {number[]} sides
 */
function rowsOf({turn, tilt}, [x, y, z]) {
  const order = z > SLENDER * Math.max(x, y) ? [2, 0, 1] : y > x ? [1, 0, 2] : [0, 1, 2];
  const [c, s, cc, ss] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
  const rows = [
    [c, s, 0],
    [-ss * s, ss * c, cc],
    [cc * s, -cc * c, ss],
  ];
  const isMirrored = order[0] === 1;
  return rows.map((row) =>
    [0, 1, 2].map((axis) => row[order.indexOf(axis)] * (isMirrored && order[1] === axis ? -1 : 1)),
  );
}

/**
 * Ends of the edges at which a surface ends or is sharp.
 * @param {Float32Array} positions
 * @param {Uint32Array} triangles
 */
function edgesOf(positions, triangles) {
  const count = positions.length / 3;
  const normals = new Float64Array(triangles.length);
  const open = new Map(); // triangle of each edge by its ends
  /** @type {number[]} */
  const sharp = [];
  for (let at = 0; at < triangles.length; at += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => 3 * triangles[at + corner]);
    const [u, v] = [b, c].map((end) => [0, 1, 2].map((axis) => positions[end + axis] - positions[a + axis]));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    normals.set(
      normal.map((each) => each / (Math.hypot(...normal) || 1)),
      at,
    );
    for (let side = 0; side < 3; side += 1) {
      const [one, other] = [triangles[at + side], triangles[at + ((side + 1) % 3)]];
      const key = Math.min(one, other) * count + Math.max(one, other);
      const last = open.get(key);
      if (last === undefined) open.set(key, at);
      else {
        open.delete(key);
        const along = [0, 1, 2].reduce((sum, axis) => sum + normals[at + axis] * normals[last + axis], 0);
        if (Math.abs(along) < SHARP) sharp.push(one, other);
      }
    }
  }
  for (const key of open.keys()) sharp.push(Math.floor(key / count), key % count);
  return new Uint32Array(sharp);
}

/** What draws a surface on a canvas; null without WebGL2. @param {HTMLCanvasElement} canvas */
function painterOn(canvas) {
  const gl = canvas.getContext('webgl2');
  if (!gl || gl.isContextLost()) return null;
  const program = gl.createProgram();
  for (const {kind, text} of [
    {kind: gl.VERTEX_SHADER, text: VERTEX},
    {kind: gl.FRAGMENT_SHADER, text: FRAGMENT},
  ]) {
    const shader = gl.createShader(kind);
    if (!shader) return null;
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return null;
  gl.useProgram(program);
  /** @param {string} name */
  const at = (name) => gl.getUniformLocation(program, name);
  const [triangleBuffer, edgeBuffer] = [gl.createBuffer(), gl.createBuffer()];
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  for (const [name, value] of [
    [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
  ])
    gl.texParameteri(gl.TEXTURE_2D, name, value);
  gl.enable(gl.DEPTH_TEST);
  /** @type {Record<string, WebGLBuffer>} */
  const buffers = {};
  let [triangleCount, edgeCount] = [0, 0];
  /** @param {WebGLBuffer} buffer @param {Uint32Array} [values] */
  const index = (buffer, values) => {
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    if (values) gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, values, gl.STATIC_DRAW);
  };
  return {
    /** @param {string} attribute @param {Float32Array} values @param {number} size */
    give(attribute, values, size) {
      const place = gl.getAttribLocation(program, attribute);
      gl.bindBuffer(gl.ARRAY_BUFFER, (buffers[attribute] ??= gl.createBuffer()));
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
    },
    /** @param {Uint32Array} triangles @param {Uint32Array} edges */
    join(triangles, edges) {
      index(triangleBuffer, triangles);
      index(edgeBuffer, edges);
      [triangleCount, edgeCount] = [triangles.length, edges.length];
    },
    /** @param {string} scale */
    colour(scale) {
      const shades = Uint8Array.from(
        {length: 4 * SHADES},
        (_, place) => [...colourAt(scale, Math.floor(place / 4) / (SHADES - 1)), 255][place % 4],
      );
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, SHADES, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, shades);
    },
    /**
     * @param {{rows: number[][], middle: number[], sides: number[], size: number, motion: number, reach: number,
     *   ends: number[], ink: number[]}} shown
     */
    draw({rows, middle, sides, size, motion, reach, ends, ink}) {
      const {width, height} = canvas;
      // of the box as it is seen
      const [right, up] = rows.map((row) => row.reduce((sum, each, axis) => sum + Math.abs(each) * sides[axis], 0));
      const half = Math.max(right / width, up / height) / (2 * size * FILL); // of the length that a pixel shows
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix3fv(at('rows'), true, rows.flat());
      gl.uniform3fv(at('middle'), middle);
      gl.uniform2f(at('scale'), 1 / (half * width), 1 / (half * height));
      gl.uniform1f(at('motion'), motion);
      gl.uniform1f(at('reach'), reach);
      gl.uniform2fv(at('ends'), ends);
      gl.uniform3fv(at('ink'), ink);
      /** @param {WebGLBuffer} buffer @param {number} kind @param {number} count @param {number} isEdge */
      const part = (buffer, kind, count, isEdge) => {
        index(buffer);
        gl.uniform1i(at('isEdge'), isEdge);
        gl.drawElements(kind, count, gl.UNSIGNED_INT, 0);
      };
      part(triangleBuffer, gl.TRIANGLES, triangleCount, 0);
      part(edgeBuffer, gl.LINES, edgeCount, 1);
    },
  };
}

/**
 * Surface of a canvas and its size in pixels, kept through the loss of its context; the painter is undefined at first
 * and null without WebGL2.
 * @param {import('../vendor/htm-preact-3.1.1.js').Ref<HTMLCanvasElement>} canvas
 */
function usePainter(canvas) {
  const [painter, setPainter] = useState(/** @type {Painter|null|undefined} */ (undefined));
  const [size, setSize] = useState([0, 0]);
  useLayoutEffect(() => {
    const element = canvas.current;
    const begin = () => setPainter(painterOn(element));
    /** @param {Event} event */
    const lose = (event) => {
      event.preventDefault(); // so that it is restored
      setPainter(null);
    };
    const watch = new ResizeObserver(() =>
      setSize([element.clientWidth, element.clientHeight].map((side) => Math.round(side * devicePixelRatio))),
    );
    watch.observe(element);
    element.addEventListener('webglcontextlost', lose);
    element.addEventListener('webglcontextrestored', begin);
    begin();
    return () => watch.disconnect();
  }, []);
  return {painter, size};
}

/**
 * Surface coloured by a value, at `amplitude * sin(phase)` of its shape; a table of the numbers belongs beside it.
 * @param {SurfaceProps} props
 */
export function SurfaceView({
  positions,
  triangles,
  values,
  shape,
  amplitude = 0,
  phase = Math.PI / 2,
  label,
  quantity,
  unit,
  scale = 'viridis',
  names = AXES,
  hasEdges = true,
  test = 'surface',
}) {
  const canvas = useRef(null);
  const [view, setView] = useState(FIRST);
  const [theme, setTheme] = useState(0);
  const {painter, size} = usePainter(canvas);
  const box = useMemo(() => boxOf(positions), [positions]);
  const edges = useMemo(
    () => (hasEdges ? edgesOf(positions, triangles) : new Uint32Array(0)),
    [positions, triangles, hasEdges],
  );
  const ends = useMemo(() => extent(values), [values]);
  const largest = useMemo(() => largestOf(shape ?? []), [shape]);
  const sides = box.sides.map((side) => side + 2 * Math.abs(amplitude) * largest); // with the motion
  const rows = rowsOf(view, box.sides);
  useEvents(['themechange'], () => setTheme((old) => old + 1));
  useLayoutEffect(() => painter?.give('position', positions, 3), [painter, positions]);
  useLayoutEffect(() => painter?.join(triangles, edges), [painter, triangles, edges]);
  useLayoutEffect(() => painter?.give('value', values, 1), [painter, values]);
  useLayoutEffect(
    () => painter?.give('shape', shape ?? new Float32Array(positions.length), 3),
    [painter, positions, shape],
  );
  useLayoutEffect(() => painter?.colour(scale), [painter, scale]);
  useLayoutEffect(() => {
    if (!painter || !size[0]) return;
    [canvas.current.width, canvas.current.height] = size;
    painter.draw({
      rows,
      middle: box.middle,
      sides,
      size: view.size,
      motion: amplitude * Math.sin(phase),
      reach: Math.hypot(...sides) || 1,
      ends: ends[1] > ends[0] ? ends : [ends[0] - 1, ends[0] + 1],
      ink: rgb(getComputedStyle(canvas.current).color).map((part) => part / 255),
    });
  }, [painter, size, positions, triangles, values, shape, scale, amplitude, phase, view, theme]);
  /** @param {WheelEvent} event */
  const wheel = (event) => {
    if (document.activeElement !== canvas.current) return; // the page scrolls
    event.preventDefault();
    setView((old) => sized(old, ZOOM ** (-event.deltaY / 100)));
  };
  /** @param {KeyboardEvent} event */
  const press = (event) => {
    const step = STEPS[event.key === '=' ? '+' : event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    setView(step[0]);
  };
  /** @param {PointerEvent} event */
  const move = (event) =>
    event.buttons &&
    canvas.current.hasPointerCapture(event.pointerId) &&
    setView((old) => ({
      ...old,
      turn: old.turn + PER_PIXEL * event.movementX,
      tilt: old.tilt + PER_PIXEL * event.movementY,
    }));
  const isDrawn = painter !== null;
  return html`<div class="surface" data-test=${test}>
    <div class="surface-row">
      <canvas
        ref=${canvas}
        role="img"
        tabindex=${isDrawn ? 0 : undefined}
        class="surface-canvas"
        hidden=${!isDrawn}
        aria-label=${label}
        onKeyDown=${press}
        onWheel=${wheel}
        onPointerDown=${(event) => canvas.current.setPointerCapture(event.pointerId)}
        onPointerMove=${move}
        data-test=${`${test}-canvas`}
      />
      ${
        isDrawn &&
        html`
          <${Directions} rows=${rows} names=${names} />
          <${ColourScale}
            field=${{values: [ends], scale, scale_text: unit ? `${quantity} (${unit})` : quantity}}
            height=${220}
          />
        `
      }
    </div>
    ${
      !isDrawn &&
      html`<p class="notice" role="status" data-test="no-webgl">
        This browser has no WebGL2 at present, so the body is not drawn; its numbers stand in the table.
      </p>`
    }
    ${
      isDrawn &&
      html`<div class="row surface-tools" role="group" aria-label="View">
        ${Object.entries(STEPS).map(
          ([key, [step, sign, name]]) => html`<${Button}
            key=${key}
            kind="icon"
            aria-label=${name}
            title=${`${name} (${key})`}
            onClick=${() => setView(step)}
            data-test=${`${test}:${key}`}
          >
            ${sign}
          <//>`,
        )}
        <span class="hint">
          ${
            amplitude !== 0 &&
            largest > 0 &&
            `The largest displacement is drawn as ${(
              (100 * (Math.abs(amplitude) * largest)) /
              Math.max(...box.sides)
            ).toPrecision(2)} % of the longest side. `
          }Drag, or keys in the picture: arrows, + and −, Home.
        </span>
      </div>`
    }
  </div>`;
}

/**
 * Directions of x, y and z as they are seen.
 * @param {{rows: number[][], names: string[]}} props
 */
const Directions = ({
  rows,
  names,
}) => html`<svg class="surface-directions" viewBox="-30 -30 60 60" width="60" height="60" aria-hidden="true">
  ${names.map(
    (name, axis) => html`<g key=${name}>
      <path d=${`M0 0L${18 * rows[0][axis]} ${-18 * rows[1][axis]}`} stroke="currentColor" stroke-width="1.5" />
      <text x=${25 * rows[0][axis]} y=${-25 * rows[1][axis]} dy="0.35em" text-anchor="middle">${name}</text>
    </g>`,
  )}
</svg>`;

/**
 * Surface that moves along its shape, with its controls: play and pause, phase, slow; still at first where motion is
 * not wanted.
 * @param {Omit<SurfaceProps, 'phase'>} props
 */
export function MovingSurface(props) {
  const [isPlaying, setPlaying] = useState(() => !matchMedia('(prefers-reduced-motion: reduce)').matches);
  const [isSlow, setSlow] = useState(false);
  const [phase, setPhase] = useState(Math.PI / 2);
  useEffect(() => {
    if (!isPlaying) return undefined;
    let [last, frame] = [performance.now(), 0];
    /** @param {number} now */
    const step = (now) => {
      const turned = ((now - last) / 1000) * Math.PI * (isSlow ? 0.1 : 1); // a period takes two seconds
      last = now;
      setPhase((old) => (old + turned) % (2 * Math.PI));
      frame = requestAnimationFrame(step);
    };
    frame = requestAnimationFrame(step);
    return () => cancelAnimationFrame(frame);
  }, [isPlaying, isSlow]);
  const degrees = Math.round((phase * 180) / Math.PI);
  /** @param {FieldEvent} event */
  const seek = (event) => {
    setPlaying(false);
    setPhase((Number(event.target.value) * Math.PI) / 180);
  };
  return html`
    <${SurfaceView} ...${props} phase=${phase} />
    <div class="row surface-motion" role="group" aria-label="Motion">
      <${Button} onClick=${() => setPlaying(!isPlaying)} data-test="play">${isPlaying ? 'Pause' : 'Play'}<//>
      <label class="surface-phase">
        Phase <input
          type="range"
          min="0"
          max="360"
          step="1"
          value=${degrees}
          onInput=${seek}
          aria-valuetext=${`${degrees}°`}
          data-test="phase"
        />
      </label>
      <label class="check">
        <input
          type="checkbox"
          checked=${isSlow}
          onChange=${(event) => setSlow(event.target.checked)}
          data-test="slow"
        /> Ten times slower
      </label>
    </div>
  `;
}
