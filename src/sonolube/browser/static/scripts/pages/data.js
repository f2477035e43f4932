/** Page Data: files of measurements, what each is, its view by its kind, and the results of all in one table. */
import {html, useEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Failure, TextTable} from '../answer.js';
import {ask} from '../api.js';
import {addFiles, dropFile, filesOf, setOwn, settingsOf, useInfo, useMeasured} from '../data/files.js';
import {NOTHING} from '../fields.js';
import {Waiting} from '../job.js';
import {Button, Card, classes, FileButton, Loading, Refusal, Sheet, useDrop} from '../parts.js';
import {change, useApp} from '../state.js';
import {save} from '../take-away.js';

/**
 * Kinds of files: title, and module. A module has `taskOf(file, own, info)`, which gives what measures a file, or null,
 * and as default a component of {file, own, set, info, asked, view}: what was set for the file, what sets more, what it
 * is, and what measures it at rest.
 */
/** @type {Record<string, [string, () => Promise<any>]>} */
const KINDS = {
  recording: ['Recording', () => import('../data/recording.js')],
  scan: ['Scan of a surface', () => import('../data/scan.js')],
  spectrum: ['Impedance spectrum', () => import('../data/spectrum.js')],
  runs: ['Table of runs', () => import('../data/runs.js')],
};

/**
 * @import {Asked, DataFile, Own} from '../data/files.js'
 * @import {ChangeOptions, Texts} from '../state.js'
 * @typedef {{asked: Asked, content: import('../answer.js').Content}} Result what was measured of a file
 */

/** Modules of kinds that were read; null for one that could not be read. */
const modules = new Map();

/** Module of a kind; undefined while it is read. @param {string|undefined} kind */
function useModule(kind) {
  const [, draw] = useState({});
  useEffect(() => {
    if (!kind || modules.has(kind)) return;
    KINDS[kind][1]()
      .catch(() => null)
      .then((module) => {
        modules.set(kind, module);
        draw({});
      });
  }, [kind]);
  return modules.get(kind);
}

/**
 * Line of a file in the list: its name, what it is, and what leaves it out; measures it and tells its result.
 * @param {{file: DataFile, own: Own, view: Texts, isShown: boolean,
 *   onResult: (upload: string, result: Result|null) => void}} props
 */
function FileLine({file, own, view, isShown, onResult}) {
  const {content: info, failure, isWaiting} = useInfo(file, own);
  const module = useModule(info?.kind);
  const asked = module?.taskOf && !info.reason ? module.taskOf(file, own, info) : null;
  const measured = useMeasured(file, asked);
  useEffect(
    () => onResult(file.upload, asked && measured.content ? {asked, content: measured.content} : null),
    [measured.content, asked === null],
  );
  const isBusy = isWaiting || measured.isWaiting || (info && module === undefined);
  const state = failure
    ? 'cannot be read'
    : !info
      ? 'reading…'
      : [
          KINDS[info.kind][0],
          `${(info.bytes / 1e6).toPrecision(2)} MB`,
          info.reason && 'needs its columns',
          isBusy && 'measuring…',
          measured.failure && 'refused',
        ]
          .filter(Boolean)
          .join(', ');
  return html`<li class=${classes('data-file', {'is-shown': isShown})} aria-busy=${Boolean(isBusy)}>
    <${Button}
      kind="data-name"
      aria-pressed=${isShown}
      onClick=${() => change({view: {file: file.upload}})}
      data-test=${`file:${file.name}`}
    >
      <strong>${file.name}</strong>
      <span class="hint" role="status">${state}</span>
    <//>
    <${Button} kind="small" onClick=${() => dropFile(view, file)} aria-label=${`Leave out ${file.name}`}>leave out<//>
  </li>`;
}

/**
 * The file that is shown, by its kind.
 * @param {{file: DataFile, own: Own, settled: Own, view: Texts}} props
 */
function Shown({file, own, settled, view}) {
  const {content: info, failure} = useInfo(file, own);
  const module = useModule(info?.kind);
  if (!info)
    return failure
      ? html`<${Failure} failure=${failure} />`
      : html`<${Loading}>Reading ${file.name}…<//><p class="row"><${Waiting} isWaiting=${true} /></p>`;
  if (module === null) return html`<p class="notice">${KINDS[info.kind][0]}: this workbench has no view of it yet.</p>`;
  if (!module) return html`<${Loading}>Reading the view…<//>`;
  /** @param {Own} partial @param {ChangeOptions} [options] */
  const set = (partial, options) => setOwn(view, file, partial, options);
  const asked = module.taskOf && !info.reason ? module.taskOf(file, settled, info) : null;
  return html`<${module.default}
    key=${file.upload}
    file=${file}
    own=${own}
    set=${set}
    info=${info}
    asked=${asked}
    view=${view}
  />`;
}

/**
 * Results of all files: their quantities in one table, and tables of the same columns one below the other.
 * @param {{files: DataFile[], results: Record<string, Result|null>}} props
 */
function Results({files, results}) {
  const known = files.flatMap(({name, upload}) => {
    const result = results[upload];
    return result ? [{...result.content, name, task: result.asked.task}] : [];
  });
  if (!known.length) return null;
  /** @type {Map<string, {heads: string[], rows: string[][]}>} */
  const groups = new Map();
  for (const {name, blocks} of known) {
    for (const block of blocks) {
      const heads = block.kind === 'rows' ? ['Quantity', 'Value'] : block.heads;
      if (!heads) continue;
      const key = heads.join('\n');
      const rows = (block.rows ?? []).map((row) => [name, ...row]);
      groups.set(key, {heads, rows: [...(groups.get(key)?.rows ?? []), ...rows]});
    }
  }
  const take = async () => {
    const answers = known.map(({name, task, answer}) => ({name, task, answer}));
    const {content} = await ask('api/measured-table', {body: {answers}});
    if (content) save({name: 'results.csv', kind: 'text/csv', text: content.csv});
  };
  return html`<${Card} id="results-title" title="Results of all files" data-test="results">
    ${[...groups.values()].map(
      ({heads, rows}) => html`<${TextTable} key=${heads.join()} heads=${['File', ...heads]} rows=${rows} />`,
    )}
    <p><${Button} onClick=${take} data-test="take-results">Save as CSV<//></p>
  <//>`;
}

export default function Data() {
  const {
    state: {view},
    isMoving,
  } = useApp();
  const rest = useRef(null);
  if (!isMoving) rest.current = view;
  const settled = settingsOf(rest.current ?? view); // what is measured waits until a handle rests
  const [note, setNote] = useState('');
  const [results, setResults] = useState(/** @type {Record<string, Result|null>} */ ({}));
  const files = filesOf(view);
  const own = settingsOf(view);
  const shown = files.find(({upload}) => upload === view.file) ?? files[0];
  /** @param {File[]} given */
  const add = async (given) => {
    setNote(`Reading ${given.length === 1 ? given[0].name : `${given.length} files`}…`);
    setNote(await addFiles(view, given));
  };
  const isDropping = useDrop(add);
  /** @param {string} upload @param {Result|null} result */
  const onResult = (upload, result) => setResults((old) => (old[upload] === result ? old : {...old, [upload]: result}));
  const choose = html`<${FileButton}
    label="Files of measurements"
    onFiles=${add}
    test="data-files"
    data-test="choose-files"
    kind=${classes('button', {'is-main': !files.length})}
  >
    Choose files…
  <//>`;
  return html`<${Sheet} title="Data">
    ${
      files.length === 0 &&
      html`<div class="data-empty">
        <p>Drop recordings, scans of surfaces, impedance spectra or tables of runs here, several at once.</p>
        ${choose}
        <p class="hint">They stay on this computer, in a folder of the workbench that goes when it ends.</p>
      </div>`
    }
    ${
      files.length > 0 &&
      html`<ul class="data-files" aria-label="Files">
        ${files.map(
          (file) => html`<${FileLine}
            key=${file.upload}
            file=${file}
            view=${view}
            own=${settled[file.upload] ?? NOTHING}
            isShown=${file === shown}
            onResult=${onResult}
          />`,
        )}
        <li>${choose}</li>
      </ul>`
    }
    <${Refusal} text=${note} role="status" data-test="data-note" />
    ${
      shown &&
      html`<${Shown}
        key=${shown.upload}
        file=${shown}
        own=${own[shown.upload] ?? NOTHING}
        settled=${settled[shown.upload] ?? NOTHING}
        view=${view}
      />`
    }
    <${Results} files=${files} results=${results} />
    ${isDropping && html`<div class="drop" aria-hidden="true">Drop the files here</div>`}
  <//>`;
}
