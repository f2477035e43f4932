/** Table of own runs: rows that are typed, pasted, switched off and removed; each change is a new table of the view. */
import {html, useEffect, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask, useReply} from './api.js';
import {NOTHING, uploadOf} from './fields.js';
import {folderEntry, isInFolder, keep, readFolder} from './folder-runs.js';
import {Button, Refusal, Select} from './parts.js';
import {change, entryNow} from './state.js';
import {save} from './take-away.js';
/** @import {Texts} from './state.js' */

/**
 * @typedef {{csv: string, added: number, runs: number, used: boolean[], switched_off: number, names: string[],
 *   headings: string[], rows: string[][], choices: [string, string][]}} Sheet
 * Table of own runs; choices are columns that it may have, with their headings.
 */

const MOST = 200; // rows that are shown
const SWITCH = 'used';
const EMPTY = 'Type a run, or paste rows of a spreadsheet.';
/** Columns that are shown first. */
const FIRST = [
  'vibration_amplitude',
  'voltage_peak_to_peak',
  'sliding_speed',
  'friction_force',
  'intrinsic_friction_force',
];
/** The last change that was asked for, after which the next one begins. */
let turn = Promise.resolve('');
const FEWEST = 3; // columns of a table that needs no others

/** Number of runs in words. @param {Sheet} sheet @returns {string} */
export const counted = ({runs, switched_off}) =>
  `${runs} own ${runs === 1 ? 'run' : 'runs'}${switched_off ? `, ${switched_off} of them switched off` : ''}.${
    runs > MOST ? ` The table shows the first ${MOST}.` : ''
  }`;

/** Heading of a column. @param {Sheet|undefined} sheet @param {string} name @returns {string} */
const headingOf = (sheet, name) => sheet?.headings[sheet.names.indexOf(name)] ?? name;

/**
 * Make a table the one of the view; one without a row leaves it out.
 * @param {Sheet} sheet
 * @returns {Promise<string>} why it was not taken
 */
export async function takeSheet(sheet) {
  const made = sheet.csv ? await ask('api/uploads', {raw: new Blob([sheet.csv])}) : null;
  if (made?.failure) return made.failure.text;
  const entry = made && `${made.content.upload} own-runs.csv`;
  const refused = await keep(entry ?? '');
  if (!refused) change({view: {runs: entry}});
  return refused;
}

/**
 * Make an upload the table of own runs of the view, or add it to that of the folder of the rig.
 * @param {{upload: string, name: string}} file
 * @param {string} [page] that is shown then
 * @returns {Promise<string>} why it was not taken
 */
export async function takeUpload({upload, name}, page) {
  if (!isInFolder()) {
    change({...(page && {page}), view: {runs: `${upload} ${name}`}});
    return '';
  }
  const before = entryNow('runs') ?? folderEntry();
  const body = {table: {upload, name}, ...(before && {runs: uploadOf(before)})};
  const {content, failure} = await ask('api/measured-use', {body});
  const refused = failure?.text ?? (await takeSheet(content));
  if (!refused && page) change({page});
  return refused;
}

/**
 * Note on the last file, and the function that makes it the table of own runs, or a part of that of a folder.
 * @returns {[string, (file: File|undefined) => Promise<void>]}
 */
export function useRunsFile() {
  const [note, setNote] = useState('');
  /** @param {File|undefined} file */
  const take = async (file) => {
    const reply = file && (await ask('api/uploads', {raw: file}));
    const upload = reply?.content?.upload;
    setNote(reply?.failure?.text ?? (upload ? await takeUpload({upload, name: file?.name ?? ''}) : ''));
  };
  return [note, take];
}

/**
 * Cell of a run; what is typed stays while the table is read anew, and where it is refused.
 * @param {{text: string, onText: (text: string) => Promise<string>, [name: string]: any}} props `onText` returns why a
 *   text was not taken; further ones go to the input
 */
function Cell({text, onText, ...rest}) {
  const [draft, setDraft] = useState(/** @type {string|null} */ (null));
  return html`<input
    type="text"
    class="cell"
    value=${draft ?? text}
    onInput=${(event) => setDraft(event.target.value)}
    onChange=${async (event) => (await onText(event.target.value)) || setDraft(null)}
    ...${rest}
  />`;
}

/**
 * Whether a run is used; what is chosen stays until the table says so too, and falls back where it is refused.
 * @param {{isUsed: boolean|undefined, onSwitch: (isUsed: boolean) => Promise<string>, [name: string]: any}} props
 *   `onSwitch` returns why the choice was not taken; further ones go to the input
 */
function Switch({isUsed, onSwitch, ...rest}) {
  const [choice, setChoice] = useState(/** @type {boolean|null} */ (null));
  useEffect(() => setChoice(null), [isUsed]);
  /** @param {boolean} chosen */
  const take = async (chosen) => {
    setChoice(chosen);
    if (await onSwitch(chosen)) setChoice(null);
  };
  return html`<input
    type="checkbox"
    checked=${choice ?? isUsed}
    onChange=${(event) => take(event.target.checked)}
    ...${rest}
  />`;
}

/**
 * @param {{view: Texts, disagreeing?: number[]}} props numbers of the runs, from 1 and among those that are used, which
 *   disagree with the others
 */
export function RunsTable({view, disagreeing = []}) {
  const [note, setNote] = useState('');
  const [further, setFurther] = useState(/** @type {string[]} */ ([]));
  const runs = view.runs && uploadOf(view.runs);
  const {content, failure} = useReply('own-runs', 'api/own-runs', runs ? {runs} : NOTHING);
  /** Change the table as it is after all changes before; why that was refused. @param {object} action */
  const act = (action) => {
    turn = turn.then(async () => {
      const before = entryNow('runs');
      const reply = await ask('api/own-runs', {body: {...(before && {runs: uploadOf(before)}), ...action}});
      const refused = reply.failure?.text ?? (await takeSheet(reply.content));
      const wasKnown = 'text' in action && !refused && !reply.content.added;
      setNote(refused || (wasKnown ? 'These rows are in the table already.' : ''));
      return refused;
    });
    return turn;
  };
  /** @type {Sheet|undefined} */
  const sheet = content;
  const own = sheet?.names.filter((name) => name !== SWITCH) ?? [];
  const places = new Map(sheet?.choices.map(([name], place) => [name, place]));
  const names = [...new Set([...own, ...(own.length < FEWEST ? FIRST : []), ...further])].sort(
    (one, other) => (places.get(one) ?? Infinity) - (places.get(other) ?? Infinity) || 0,
  ); // a cell in which one types stays where it is
  const headings = new Map([
    ...(sheet?.choices ?? []),
    ...own.map((name) => /** @type {[string, string]} */ ([name, headingOf(sheet, name)])),
  ]);
  const columns = names.map((name) => [name, headings.get(name) ?? name]);
  const numbers = sheet?.used.map((isUsed, row) => (isUsed ? sheet.used.slice(0, row + 1).filter(Boolean).length : 0));
  const count = Math.min(sheet?.rows.length ?? 0, MOST);
  /** @param {number} row */
  const rowOf = (row) => html`<tr key=${row} class=${sheet?.used[row] === false ? 'is-off' : undefined}>
    <th scope="row">${row + 1}</th>
    <td>
      ${
        row < count &&
        html`<${Switch}
          isUsed=${sheet?.used[row]}
          aria-label=${`Use run ${row + 1}`}
          data-test="use-run"
          onSwitch=${(used) => act({switch: {row, used}})}
        />`
      }
    </td>
    ${columns.map(
      ([name, heading]) => html`<td key=${name}>
        <${Cell}
          text=${sheet?.rows[row]?.[sheet.names.indexOf(name)] ?? ''}
          aria-label=${`${heading}, run ${row + 1}`}
          data-test=${`cell:${row}:${name}`}
          onText=${(text) => act({edit: {row, name, text}})}
        />
      </td>`,
    )}
    <td>
      ${disagreeing.includes(numbers?.[row] ?? -1) && html`<strong class="tag">disagrees with the others</strong>`}
      ${
        row < count &&
        html`<${Button}
          kind="small"
          onClick=${() => act({remove: row})}
          aria-label=${`Remove run ${row + 1}`}
          data-test="remove-run"
        >
          remove
        <//>`
      }
    </td>
  </tr>`;
  return html`
    ${failure?.faults.map(({text}) => html`<${Refusal} key=${text} text=${text} role="alert" />`)}
    ${
      !failure &&
      html`<div class="table-frame" tabindex="0" role="group" aria-label="Own runs">
        <table class="table runs-table" data-test="runs-table">
          <thead>
            <tr>
              <th scope="col">run</th>
              <th scope="col">used</th>
              ${columns.map(([name, heading]) => html`<th key=${name} scope="col">${heading}</th>`)}
              <th scope="col"><span class="hidden">Changes</span></th>
            </tr>
          </thead>
          <tbody>
            ${[...Array(Math.min(count + 1, MOST)).keys()].map(rowOf)}
          </tbody>
        </table>
      </div>`
    }
    <p class="hint" role="status" data-test="runs-note">
      ${note || (sheet?.rows.length ? counted(sheet) : EMPTY)}
    </p>
    <p class="row">
      <textarea
        class="paste"
        rows="1"
        aria-label="Paste rows of a spreadsheet"
        placeholder="Paste rows of a spreadsheet"
        data-test="paste-runs"
        onInput=${(event) => {
          const text = event.target.value;
          event.target.value = '';
          if (text.trim()) act({text});
        }}
      ></textarea>
      <${Select}
        choices=${[['', 'Add a column…'], ...(sheet?.choices ?? []).filter(([name]) => !names.includes(name))]}
        value=""
        aria-label="Add a column"
        data-test="add-column"
        onChange=${(event) => setFurther([...further, event.target.value])}
      />
      ${
        isInFolder() &&
        html`<${Button} onClick=${async () => setNote(await readFolder())} data-test="read-folder">
          Read runs.csv again
        <//>`
      }
      ${
        sheet?.rows.length
          ? html`<${Button}
              onClick=${() => save({name: 'own-runs.csv', kind: 'text/csv', text: sheet.csv})}
              data-test="take-runs"
            >
              Save own runs (CSV)
            <//>`
          : null
      }
    </p>
  `;
}
