/** Where measured numbers go: entries of the rig, and rows of a table of own runs, which predictions then use. */
import {html, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask, useReply} from '../api.js';
import {NOTHING, uploadOf} from '../fields.js';
import {Button, Card, Refusal} from '../parts.js';
import {useRig} from '../rig-panel.js';
import {counted, RunsTable, takeSheet} from '../runs-table.js';
import {addressOf, change, useApp} from '../state.js';

/**
 * @param {{source: object|null}} props `source` is what a request of "measured-use" has beside the runs: results and
 *   conditions, or a table; null for none
 */
export function Use({source}) {
  const {
    state: {rig, view},
  } = useApp();
  const {view: rigView} = useRig();
  const [note, setNote] = useState('');
  const {content, failure} = useReply('use', source && 'api/measured-use', source ?? NOTHING);
  const known = new Set(rigView?.fields.map(({key}) => key));
  /** @type {{key: string, text: string}[]} */
  const measured = content?.entries ?? [];
  const entries = measured.filter(({key}) => known.has(key.replace('uncertainty.', '')));
  const set = () => {
    change({
      rig: {...rig, changes: {...rig.changes, ...Object.fromEntries(entries.map(({key, text}) => [key, text]))}},
    });
    setNote(`In the rig: ${entries.map(({key, text}) => `${key} ${text}`).join(', ')}.`);
  };
  const runs = view.runs && uploadOf(view.runs);
  const add = async () => {
    const made = await ask('api/measured-use', {body: {...source, ...(runs && {runs})}});
    const refused = made.failure?.text ?? (made.content.runs ? await takeSheet(made.content) : '');
    const {added, runs: count} = made.content ?? {};
    const known = count ? 'In the table already: ' : 'There is no level of friction to add.';
    setNote(refused || `${added ? `${added} added: ` : known}${count ? counted(made.content) : ''}`);
  };
  return html`<${Card} id="use-title" title="Use the result" data-test="use">
    ${failure?.faults.map(({text}) => html`<${Refusal} key=${text} text=${text} role="alert" />`)}
    ${entries.length > 0 && html`<p class="hint">${entries.map(({key, text}) => `${key} = ${text}`).join(', ')}</p>`}
    <p class="row">
      <${Button} disabled=${!entries.length} onClick=${set} data-test="use-in-rig">Use in my rig<//>
      <${Button} disabled=${!source} onClick=${add} data-test="add-to-runs">Add to my runs<//>
      ${
        runs &&
        html`
          <a class="button" href=${addressOf('predict', {runs: view.runs})} data-test="predict-with-runs">
            Predict with own runs
          </a>
        `
      }
    </p>
    <p class="hint" role="status" data-test="use-note">${note}</p>
    ${runs && html`<${RunsTable} view=${view} />`}
  <//>`;
}
