/** What is measured of a file: the settings of its task, the answer, and what the rig takes of it. */
import {html, useEffect} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings, Failure, TextTable} from '../answer.js';
import {Chart} from '../chart.js';
import {Labelled, refusedBy, TextField} from '../fields.js';
import {Waiting} from '../job.js';
import {Button, Card, classes, Select} from '../parts.js';
import {addressOf, change, settle, useApp} from '../state.js';
import {offer} from '../take-away.js';
import {useMeasured} from './files.js';

/** @import {Own, SetOwn} from './files.js' */

/** Entries of a record that say something. @param {Record<string, any>} entries @returns {Record<string, any>} */
export const stated = (entries) =>
  Object.fromEntries(
    Object.entries(entries).filter(([, value]) => value !== undefined && value !== null && value !== ''),
  );

/**
 * Text fields of what is set for a file, each with its refusal.
 * @param {{fields: string[][], own: Own, set: SetOwn, faults?:
 *   import('../api.js').Fault[]}} props `fields` have name, label, and what stands in an empty one
 */
export const Settings = ({fields, own, set, faults = []}) =>
  html`<div class="study-texts">
    ${fields.map(([name, label, placeholder = 'usual']) => {
      const fault = faults.find(({key, text}) => key === name || (!key && text.startsWith(name)))?.text;
      const id = `set-${name}`;
      return html`<${Labelled} key=${name} id=${id} label=${label} refusal=${fault}>
        <${TextField}
          id=${id}
          text=${own[name] ?? ''}
          placeholder=${placeholder}
          onText=${(text, isMoving) => !isMoving && set({[name]: text.trim() || null})}
          onSettle=${settle}
          data-test=${`set:${name}`}
          ...${refusedBy(id, fault)}
        />
      <//>`;
    })}
  </div>`;

/**
 * Choice of what is set for a file.
 * @param {{name: string, label: string, choices: [string, string][], value: string, onValue: (value: string) => void}}
 *   props
 */
export const Choice = ({name, label, choices, value, onValue}) => html`<${Labelled} id=${`set-${name}`} label=${label}>
  <${Select}
    id=${`set-${name}`}
    choices=${choices}
    value=${value}
    onChange=${(event) => onValue(event.target.value)}
    data-test=${`set:${name}`}
  />
<//>`;

/**
 * Choices of a whole number from 1, or of none.
 * @param {string} none
 * @param {number} most
 * @returns {[string, string][]}
 */
export const countsTo = (none, most) =>
  /** @type {[string, string][]} */ ([
    ['', none],
    ...Array.from({length: most}, (_, at) => [String(at + 1), String(at + 1)]),
  ]);

/**
 * What the rig takes of an answer, and what sets it there.
 * @param {{entries: Object<string, string>, note: string}} props
 */
function UseInRig({entries, note}) {
  const {
    state: {rig},
  } = useApp();
  const isSet = Object.entries(entries).every(([key, text]) => rig.changes[key] === text);
  return html`<${Card} id="use-in-rig" title="Use in my rig">
    <${TextTable} heads=${['Entry', 'Measured']} rows=${Object.entries(entries)} />
    <p class="hint">${note}</p>
    <p class="row">
      <${Button}
        disabled=${isSet}
        onClick=${() => change({rig: {...rig, changes: {...rig.changes, ...entries}}})}
        data-test="use-in-rig"
      >
        Set in ${rig.name}
      <//>
      <span role="status">${isSet && html`Set. <a href=${addressOf('predict')}>See the prediction</a>`}</span>
    </p>
  <//>`;
}

/**
 * Answer of the task that measures a file: figures, numbers, caveats, what the rig takes; made anew for another task.
 * @param {{file: import('./files.js').DataFile, asked: import('./files.js').Asked|null, fields: string[][], own: Own,
 *   set: SetOwn, leave?: string[], rigNote: string, isFigureFirst?: boolean, children?: any}} props `leave` names
 *   figures that are shown elsewhere; `children` stand beside the fields
 */
export function Measured({file, asked, fields, own, set, leave = [], rigNote, isFigureFirst, children}) {
  const {content, failure, isWaiting} = useMeasured(file, asked);
  useEffect(() => (asked ? offer(asked.task, asked.args) : undefined), [JSON.stringify(asked)]);
  const isOld = isWaiting || Boolean(failure);
  const charts = content ? drawings(content).filter(({name}) => !leave.includes(name)) : [];
  const entries = content?.answer.results[0]?.rig_entries;
  return html`
    <${Settings} fields=${fields} own=${own} set=${set} faults=${failure?.faults} />
    ${children}
    <div class="row study-status"><${Waiting} isWaiting=${isWaiting} /></div>
    <${Failure} failure=${failure} shown=${fields.map(([name]) => name)} />
    ${
      content &&
      html`<div
        aria-busy=${isWaiting}
        class=${classes('measured', {'is-figure-first': isFigureFirst})}
        data-test="measured"
      >
        <div class="columns">
          <div class="stack">
            <${Card} id="measured-numbers" title="Result" isDim=${isOld}><${Blocks} blocks=${content.blocks} /><//>
          </div>
          <div class="stack">
            ${entries && html`<${UseInRig} entries=${entries} note=${rigNote} />`}
            <${Card} id="measured-caveats" title="Caveats" isTitleHidden=${true}>
              <${Caveats} answer=${content} isMoving=${isWaiting} of=${JSON.stringify(asked)} hasFields=${false} />
            <//>
          </div>
        </div>
        <div class="measured-figures">
          ${charts.map((one) => html`<${Chart} key=${one.name} ...${one} dimmed=${isOld} />`)}
        </div>
      </div>`
    }
  `;
}
