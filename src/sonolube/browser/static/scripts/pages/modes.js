/**
 * Page Modes: natural modes, tuning and impedance of a part, as a job; its modes in motion, tables, drawing and files.
 */
import {html, useEffect, useMemo, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings} from '../answer.js';
import {ask, useReply} from '../api.js';
import {Chart} from '../chart.js';
import {Labelled, NOTHING, refusedBy, TextField, uploadOf, useFile} from '../fields.js';
import {isActive, JobState, useJob} from '../job.js';
import {Button, Card, FileButton, fileOf, Loading, Refusal, Select, words} from '../parts.js';
import {change, settle, useApp} from '../state.js';
import {MovingSurface} from '../surface-view.js';
import {offer} from '../take-away.js';

/**
 * @import {Content} from '../answer.js'
 * @import {Texts} from '../state.js'
 * @typedef {{name: string, is_horn: boolean, is_transducer: boolean, sizes: {name: string, label: string, start?:
 *   string, default?: string}[]}} Part
 * @typedef {{parts: Part[], material: string, materials: [string, string][]}} Known parts and materials of the server
 * @typedef {[string, string, string, ((text: string) => any)?]} Text argument, label, usual value, way from the text
 * @typedef {{accept: string, entry: string, choose: string}} ChosenFile
 * @typedef {{title: string, task: string, args: object, texts: Text[], part?: string, isOffered?: (part: Part) =>
 *   boolean, accept?: string, entry?: string, choose?: string}} Work
 * @typedef {{name: string, work: Work, args: any, file: Partial<ChosenFile>|null, offered?: Part[], part?: Part|null}}
 *   Asked
 * @typedef {{name: string, frequency: string, shape: string, stress?: string, peak_stress: number|null, reference:
 *   string, end_ratio?: number|null, nodal_planes?: number[]|null}} Mode
 * @typedef {{positions: Float32Array, triangles: Uint32Array, axis: string, modes: Mode[]}} Shapes
 */

/** @param {string} text @returns {string[]} */
const list = (text) => text.split(/[\s;]+/).filter(Boolean);
/** @type {[string, string]} */
const ERROR = ['tolerance', 'Largest error of a frequency, which sets the mesh'];
/** @type {Text} */
const AMPLITUDE = ['amplitude', 'Amplitude of the working end, for its stress', 'none'];
/**
 * What is computed of a part: task, part to begin with, arguments as text with label, usual value and, where it is no
 * text, the way to it.
 * @type {Record<string, Work>}
 */
const WORKS = {
  modes: {
    title: 'Natural modes',
    task: 'modes',
    part: 'stepped_horn',
    isOffered: () => true,
    args: {vtu: true},
    texts: [
      ['count', 'Number of modes', '6', Number],
      ['clamp', 'Faces held still, such as -z', 'none', list],
      [...ERROR, '0.005'],
    ],
  },
  tune: {
    title: 'Tune to a frequency',
    task: 'horn design',
    part: 'stepped_horn',
    isOffered: (part) => part.is_horn,
    args: {frequency: '20 kHz'},
    texts: [
      ['frequency', 'Frequency of the tuned mode', '20 kHz'],
      [...AMPLITUDE],
      ['gain', 'Gain, which sets the radius of the end', 'as the radii have it'],
      ['tool_mass', 'Mass of a tool on the working face', '10 g'],
      [...ERROR, '0.003'],
    ],
  },
  impedance: {
    title: 'Impedance',
    task: 'impedance compute',
    part: 'stack',
    isOffered: () => true,
    args: {vtu: true},
    texts: [
      ['lowest', 'From', '1 kHz'],
      ['highest', 'To', '60 kHz'],
      ['clamp', 'Faces held still, such as back.-z', 'none', list],
      [...AMPLITUDE],
      ['ceramic', 'Ceramic', "the part's own"],
      ['tolerance', 'Largest error of a resonance, which sets the mesh', '0.02'],
    ],
  },
  foreign: {
    title: 'Modes of another program',
    task: 'modes',
    accept: '.unv,.uff,.frd,.csv,.toml',
    entry: 'shapes',
    choose: 'Choose a file of modes…',
    args: {},
    texts: [
      ['tip', 'Nodes or points x,y,z of the contact', '', list],
      ['direction', 'From the tip to the other body, such as +z', ''],
      ['port', 'Nodes or points at both ends of the stack', '', list],
      ['force_per_volt', 'Blocked force of the stack per volt', '12 N/V'],
      ['clamped_capacitance', 'Capacitance with all modes held', '4.2 nF'],
      ['quality_factor', 'Quality factor of modes without damping', ''],
      ['static_compliance', 'Static compliance of the contact', ''],
      ['modal_mass', 'Modal mass where the file has none', '1 kg'],
      ['length_unit', 'Unit of length of the file', 'mm'],
      ['force_unit', 'Unit of force of the file', 'N'],
      ['displacement_per_volt', 'Static displacement of the contact per volt', ''],
    ],
  },
};
const STEP = {accept: '.step,.stp', entry: 'step', choose: 'Choose a STEP file…'};
const SHAPES = 'mode-shapes.json';
const [DRAWN, SIZE] = [0.08, 'size.']; // the largest displacement over the longest side; entries of sizes

/**
 * What the view asks for: its work, part, and arguments; these are null while a file is missing.
 * @param {Texts} view
 * @param {Known} known
 * @returns {Asked}
 */
function askedOf(view, known) {
  const name = Object.hasOwn(WORKS, view.work) ? view.work : 'modes';
  const work = WORKS[name];
  const typed = work.texts
    .map(([argument, , , read = String]) => [argument, read(view[`${name}.${argument}`] ?? '')])
    .filter(([, value]) => value.length !== 0 && value !== 0);
  const args = {...work.args, ...Object.fromEntries(typed)};
  if (name === 'foreign')
    return {name, work, file: work, args: view.shapes ? {...args, from_file: uploadOf(view.shapes)} : null};
  const offered = known.parts.filter((each) => work.isOffered?.(each));
  const named = offered.find((each) => each.name === view.part) ?? offered.find((each) => each.name === work.part);
  const part = view.part === 'step' ? undefined : named;
  const sizes = (part?.sizes ?? [])
    .map(({name: size, start}) => [size, view[SIZE + size] ?? (name === 'tune' ? '' : start)])
    .filter(([, text]) => text);
  const material = part?.is_transducer ? {} : {material: view.material ?? known.material};
  const given = part?.name ?? (view.step && uploadOf(view.step));
  return {
    name,
    work,
    offered,
    part: part ?? null,
    file: part ? null : STEP,
    args: given
      ? {
          part: given,
          ...(sizes.length && {sizes: Object.fromEntries(sizes)}),
          ...(name !== 'impedance' && material),
          ...args,
        }
      : null,
  };
}

/**
 * Field of an entry of the view.
 * @param {{entry: string, label: string, usual?: string, view: Texts, refusal?: string}} props
 */
function Entry({entry, label, usual, view, refusal}) {
  const id = `modes-${entry.replace('.', '-')}`;
  return html`<${Labelled} id=${id} label=${label} refusal=${refusal}>
    <${TextField}
      id=${id}
      text=${view[entry] ?? ''}
      placeholder=${usual}
      onSettle=${settle}
      onText=${(text, isMoving) => change({view: {[entry]: text.trim() || null}}, {replace: isMoving})}
      data-test=${`modes:${entry}`}
      ...${refusedBy(id, refusal)}
    />
  <//>`;
}

/**
 * Part, its sizes, and what else the work takes.
 * @param {{asked: Asked, known: Known, view: Texts, reason: string}} props
 */
function Panel({asked: {name, work, offered, part, file, args}, known, view, reason}) {
  const entry = file?.entry ?? 'step';
  const [note, take] = useFile(entry);
  const chosen = view[entry];
  /** @param {string} argument */
  const refusalOf = (argument) => (reason.split(/[ :]/)[0] === argument ? reason : undefined);
  const parts = (offered ?? []).map((each) => [each.name, words(each.name)]);
  return html`<aside class="rig" aria-label="Part" data-test="part-panel">
    ${
      offered &&
      html`<${Labelled} id="modes-part" label="Part">
        <${Select}
          id="modes-part"
          choices=${[...parts, ['step', 'a STEP file']]}
          value=${part?.name ?? 'step'}
          onChange=${(event) => change({view: {part: event.target.value}})}
          data-test="modes:part"
        />
      <//>`
    }
    ${
      file &&
      html`<div>
        <p class="row">
          <${FileButton}
            accept=${file.accept}
            label=${file.choose}
            onFile=${take}
            test="modes-file"
            data-test="choose-file"
          >
            ${file.choose}
          <//>
          ${chosen && html`<strong class="grow">${uploadOf(chosen).name}</strong>`}
        </p>
        <${Refusal} text=${note} role="alert" />
      </div>`
    }
    ${
      args?.material &&
      html`<${Labelled} id="modes-material" label="Material" refusal=${refusalOf('material')}>
        <${Select}
          id="modes-material"
          choices=${known.materials}
          value=${args.material}
          onChange=${(event) => change({view: {material: event.target.value}})}
          data-test="modes:material"
        />
      <//>`
    }
    ${
      part &&
      html`<fieldset class="fields">
        <legend>Sizes</legend>
        ${part.sizes.map(
          (size) => html`<${Entry}
            key=${`${part.name} ${size.name}`}
            entry=${SIZE + size.name}
            label=${size.label}
            usual=${name === 'tune' ? 'chosen' : size.start || size.default}
            view=${view}
            refusal=${refusalOf(size.name)}
          />`,
        )}
      </fieldset>`
    }
    <fieldset class="fields">
      <legend>${work.title}</legend>
      ${work.texts.map(
        ([argument, label, usual]) => html`<${Entry}
          key=${argument}
          entry=${`${name}.${argument}`}
          label=${label}
          usual=${usual}
          view=${view}
          refusal=${refusalOf(argument)}
        />`,
      )}
    </fieldset>
  </aside>`;
}

/**
 * Typed array of a text in base 64.
 * @template T
 * @param {string} text
 * @param {new (buffer: ArrayBuffer) => T} Kind
 * @returns {T}
 */
const numbersOf = (text, Kind) => new Kind(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);

/**
 * Job that gave an answer, with its surface and modes where it has them; null before they are read.
 * @param {{job: import('../job.js').Job|null, content: any, isOld: boolean}} job
 * @returns {(Partial<Shapes> & {id: string})|null}
 */
function useShapes({job, content, isOld}) {
  const [found, setFound] = useState(/** @type {Partial<Shapes> & {id: string, of: any}} */ ({id: '', of: null}));
  useEffect(() => {
    if (!content || isOld || !job) return;
    if (!content.files.includes(SHAPES)) setFound({id: job.id, of: content});
    else
      ask(fileOf(job.id, SHAPES)).then(
        ({content: read}) =>
          read &&
          setFound({
            id: job.id,
            of: content,
            positions: numbersOf(read.points, Float32Array),
            triangles: numbersOf(read.triangles, Uint32Array),
            axis: read.axis,
            modes: read.modes,
          }),
      );
  }, [content, isOld]);
  return content && found.of === content ? found : null;
}

/**
 * Lengths of vectors, as values of the vertices.
 * @param {Float32Array} vectors
 */
const lengthsOf = (vectors) =>
  Float32Array.from({length: vectors.length / 3}, (_, at) => Math.hypot(...vectors.subarray(3 * at, 3 * at + 3)));
/**
 * Largest of some numbers.
 * @param {Float32Array} values
 */
const most = (values) => values.reduce((largest, each) => Math.max(largest, each), -Infinity);

/**
 * Modes in a table, and the chosen one in motion.
 * @param {{shapes: Shapes, view: Texts, tuned?: string}} props
 */
function Modes({shapes, view, tuned}) {
  const {modes, positions, triangles, axis} = shapes;
  const chosen = modes.find((mode) => mode.name === (view.mode ?? tuned)) ?? modes[0];
  const isStress = view.colour === 'stress' && Boolean(chosen.stress);
  const shape = useMemo(() => numbersOf(chosen.shape, Float32Array), [chosen]);
  const sizes = useMemo(() => lengthsOf(shape), [shape]);
  const values = useMemo(
    () => (isStress ? numbersOf(chosen.stress ?? '', Float32Array) : sizes),
    [chosen, isStress, sizes],
  );
  const side = useMemo(
    () =>
      Math.max(
        ...[0, 1, 2].map((place) => {
          const along = positions.filter((_, at) => at % 3 === place);
          return most(along) + most(along.map((each) => -each));
        }),
      ),
    [positions],
  );
  /** @param {Mode} mode */
  const planes = ({nodal_planes: found}) => (found ? found.map((each) => each.toFixed(1)).join(', ') || 'none' : '–');
  /** @param {Mode} mode */
  const ratio = ({end_ratio: found}) => found?.toPrecision(3) ?? '–';
  const heads = [
    'Mode',
    'Frequency',
    `End +${axis} over end -${axis}`,
    `Nodal planes from end -${axis}, mm`,
    ...(modes[0].peak_stress === null ? [] : ['Peak stress, MPa/µm']),
  ];
  return html`<${Card} id="modes-shapes" title="Modes" data-test="shapes">
    <div class="modes-shown">
      <div>
        <${MovingSurface}
          positions=${positions}
          triangles=${triangles}
          values=${values}
          shape=${shape}
          amplitude=${(DRAWN * side) / most(sizes)}
          label=${`${chosen.name}, ${chosen.frequency}, in motion; its numbers stand in the table`}
          quantity=${isStress ? 'Equivalent stress' : 'Displacement'}
          unit=${isStress ? 'MPa/µm' : ''}
        />
        <div class="row">
          ${
            chosen.peak_stress !== null &&
            html`
              <label for="modes-colour">Colours</label>
              <${Select}
                id="modes-colour"
                value=${isStress ? 'stress' : 'displacement'}
                data-test="colour"
                choices=${[
                  ['displacement', 'Displacement'],
                  ['stress', 'Stress'],
                ]}
                onChange=${(event) => change({view: {colour: event.target.value}})}
              />
            `
          }
          <span class="hint">
            Over ${chosen.reference}.${
              chosen.peak_stress !== null &&
              ' At a sharp corner the peak stress has no limit: it grows with the finer mesh, so round it.'
            }
          </span>
        </div>
      </div>
      <div class="table-frame" tabindex="0" role="group" aria-label="Modes">
        <table class="table" data-test="mode-table">
          <caption>
            Choose a mode to see it. Ends and nodal planes are of the cross-sections along ${axis}: displacement of
            axial modes, deflection of bending ones, turn of torsional ones.
            ${
              modes[0].peak_stress !== null &&
              ' Stress is per micrometre of the largest displacement, in a tuned mode of that of the working face.'
            }
          </caption>
          <thead><tr>${heads.map((head) => html`<th key=${head} scope="col">${head}</th>`)}</tr></thead>
          <tbody>
            ${modes.map(
              (mode) => html`<tr key=${mode.name}>
                <th scope="row">
                  <label class="mode-choice">
                    <input
                      type="radio"
                      name="mode"
                      checked=${mode === chosen}
                      onChange=${() => change({view: {mode: mode.name}})}
                      data-test=${`mode:${mode.name}`}
                    /> ${mode.name}
                  </label>
                </th>
                <td>${mode.frequency}</td>
                <td>${ratio(mode)}</td>
                <td>${planes(mode)}</td>
                ${mode.peak_stress !== null && html`<td>${mode.peak_stress.toPrecision(3)}</td>`}
              </tr>`,
            )}
          </tbody>
        </table>
      </div>
    </div>
  <//>`;
}

/**
 * Answer of a job: modes, figures, drawing, numbers, caveats, files.
 * @param {{content: Content & {files: string[]}, shapes: ReturnType<typeof useShapes>, isOld: boolean, view: Texts, of:
 *   string}} props
 */
function Result({content, shapes, isOld, view, of}) {
  const files = content.files.filter((name) => name !== SHAPES);
  const drawing = files.find((name) => name.endsWith('-drawing.svg'));
  return html`<div class=${isOld ? 'is-dim' : ''} data-test="modes-result">
    ${shapes?.modes && html`<${Modes} shapes=${shapes} view=${view} tuned=${content.answer.mode} />`}
    <div class="columns">
      <div class="stack"><${Card} id="modes-numbers" title="Result"><${Blocks} blocks=${content.blocks} /><//></div>
      <div class="stack">
        <${Card} id="modes-caveats" title="Caveats and assumptions">
          <${Caveats} answer=${content} isMoving=${false} of=${of} hasFields=${false} />
        <//>
        ${
          shapes &&
          html`<${Card} id="modes-files" title="Files">
            <ul class="caveat-list">
              ${files.map(
                (name) => html`<li key=${name} class="is-file">
                  <a href=${fileOf(shapes.id, name)} download=${name} data-test=${`file:${name}`}>${name}</a>
                </li>`,
              )}
            </ul>
          <//>`
        }
      </div>
    </div>
    ${drawings(content).map((one) => html`<${Chart} key=${one.name} ...${one} dimmed=${isOld} />`)}
    ${
      shapes &&
      drawing &&
      html`<figure class="drawing">
        <img src=${fileOf(shapes.id, drawing)} alt="Drawing of the horn with its sizes" data-test="drawing" />
      </figure>`
    }
  </div>`;
}

/**
 * A work with its panel, job and answer; made anew for another work.
 * @param {{asked: Asked, known: Known, view: Texts}} props
 */
function Work({asked, known, view}) {
  const {work, args} = asked;
  const key = JSON.stringify(args);
  const job = useJob(args ? work.task : null, args);
  const shapes = useShapes(job);
  const {content, isOld, failure, isSought} = job;
  useEffect(() => (args ? offer(work.task, args) : undefined), [work.task, key]);
  const isBusy = isActive(job.job);
  return html`
    <${Panel} asked=${asked} known=${known} view=${view} reason=${(!isOld && content ? '' : job.job?.reason) ?? ''} />
    <div class="body">
      <div class="row modes-job">
        ${
          args &&
          !isSought &&
          !isBusy &&
          (isOld || !content) &&
          html`
            <${Button}
              kind="button is-main"
              data-test="start-job"
              onClick=${() =>
                job.start(`${work.title}: ${asked.part ? words(asked.part.name) : (args.from_file ?? args.part).name}`)}
            >
              ${content ? 'Compute again' : 'Compute'}
            <//>
            ${content && html`<span class="hint">What is shown is of the entries before.</span>`}
          `
        }
        ${!args && html`<p class="hint">Choose a file first.</p>`}
        ${job.job && html`<${JobState} job=${job.job} cancel=${job.cancel} />`}
        <${Refusal} text=${failure?.text} role="alert" />
      </div>
      ${content && html`<${Result} content=${content} shapes=${shapes} isOld=${isOld} view=${view} of=${key} />`}
    </div>
  `;
}

export default function ModesPage() {
  const {
    state: {view},
  } = useApp();
  const {content: known, failure} = useReply('parts', 'api/parts', NOTHING);
  const asked = known && askedOf(view, known);
  return html`<div class="workspace modes">
    <div class="lead" id="answer" tabindex="-1">
      <p class="overline">Modes</p>
      <h1 class="statement">Compute the modes of a part</h1>
      ${
        asked &&
        html`<fieldset class="choices">
          <legend>Compute</legend>
          ${Object.entries(WORKS).map(
            ([name, {title}]) => html`<label key=${name} class="choice">
              <input
                type="radio"
                name="work"
                checked=${name === asked.name}
                onChange=${() => change({view: {work: name, part: null, mode: null}})}
                data-test=${`work:${name}`}
              />
              <span>${title}</span>
            </label>`,
          )}
        </fieldset>`
      }
    </div>
    ${
      !known &&
      (failure ? html`<${Refusal} text=${failure.text} role="alert" />` : html`<${Loading}>Reading the parts…<//>`)
    }
    ${asked && html`<${Work} key=${asked.name} asked=${asked} known=${known} view=${view} />`}
  </div>`;
}
