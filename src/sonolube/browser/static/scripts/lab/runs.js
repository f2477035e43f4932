/**
 * Runs of the laboratory: listed, opened, compared in one table, and what then is fitted, predicted with, or read on
 * the page Data.
 */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, drawings, Failure} from '../answer.js';
import {ask, useConnection, useReply} from '../api.js';
import {Chart} from '../chart.js';
import {duration, isActive, JobState, useJob} from '../job.js';
import {Button, Card, Refusal} from '../parts.js';
import {takeUpload} from '../runs-table.js';
import {change, useApp} from '../state.js';
import {offer} from '../take-away.js';

/**
 * @import {RigState} from '../state.js'
 * @import {Content} from '../answer.js'
 * @typedef {{id: string, title: string, created: number, state: string, device: string, seed: number|null,
 *   duration: number, tags: string[]}} RunEntry
 */
/** @param {number} seconds @returns {string} */
const when = (seconds) => new Date(seconds * 1000).toLocaleString(undefined, {dateStyle: 'medium', timeStyle: 'short'});

/**
 * Answer of a task: figures, text, caveats.
 * @param {{answer: Content, of: string}} props
 */
export const Shown = ({answer, of}) => html`
  ${drawings(answer).map((one) => html`<${Chart} key=${one.name} ...${one} />`)}
  <${Blocks} blocks=${answer.blocks} />
  <${Caveats} answer=${answer} isMoving=${false} of=${of} hasFields=${false} />
`;

/**
 * Runs side by side, and models fitted to them.
 * @param {{compared: Content & {name: string, upload: string}, rig: RigState}} props
 */
function Compared({compared, rig}) {
  const args = {runs: {name: compared.name, upload: compared.upload}, rig};
  const job = useJob('fit', args);
  const [note, setNote] = useState('');
  useEffect(() => offer('fit', args), [JSON.stringify(args)]);
  return html`<div class="lab-opened" data-test="compared">
    <${Shown} answer=${compared} of=${compared.upload} />
    <p class="row">
      <${Button}
        kind="button is-main"
        onClick=${() => job.start(`fit to ${compared.name}`)}
        disabled=${isActive(job.job)}
        data-test="fit"
      >
        Fit models to these runs
      <//>
      <${Button}
        onClick=${async () => setNote(await takeUpload(compared, 'predict'))}
        data-test="predict-runs"
      >
        Predict with these runs
      <//>
    </p>
    <${Refusal} text=${note} role="alert" />
    ${job.job && html`<${JobState} job=${job.job} cancel=${job.cancel} />`}
    <${Failure} failure=${job.failure} />
    ${job.content && html`<div data-test="fitted"><${Shown} answer=${job.content} of="fit" /></div>`}
  </div>`;
}

/** @param {{turn: string}} properties `turn` changes where the list has to be read again */
export function Runs({turn}) {
  const {
    state: {view, rig},
  } = useApp();
  const {generation} = useConnection();
  const [{content, failure}, setFound] = useState(/** @type {Partial<import('../api.js').Reply>} */ ({}));
  const [note, setNote] = useState('');
  useEffect(() => {
    ask('api/lab/runs').then(setFound);
  }, [turn, generation]);
  const ticked = (view.ticked ?? '').split(',').filter(Boolean);
  /** @param {string} id */
  const tick = (id) =>
    change({
      view: {
        ticked: (ticked.includes(id) ? ticked.filter((other) => other !== id) : [...ticked, id]).join(',') || null,
        compare: null,
      },
    });
  const compared = useReply('lab-compare', view.compare ? 'api/lab/compare' : null, {runs: ticked});
  const opened = useReply('lab-run', view.open ? `api/lab/runs/${encodeURIComponent(view.open)}` : null, undefined);
  /** @param {string} id */
  const toData = async (id) => {
    const {content: file, failure: refused} = await ask(`api/lab/runs/${encodeURIComponent(id)}/upload`, {body: {}});
    if (file) change({page: 'data', view: {files: `${file.upload} ${file.name}`, file: file.upload}});
    setNote(refused?.text ?? '');
  };
  /** @type {RunEntry[]} */
  const runs = content?.runs ?? [];
  /** @type {string[]} */
  const caveats = content?.caveats ?? [];
  return html`<${Card} id="runs-title" title="Runs" data-test="runs">
    <${Failure} failure=${failure} />
    ${content && !runs.length && html`<p class="hint" data-test="no-runs">No runs yet in ${content.folder}.</p>`}
    ${
      runs.length > 0 &&
      html`
        <div class="table-frame" tabindex="0" role="group" aria-label="Runs">
          <table class="table">
            <thead>
              <tr>
                ${['Compare', 'Run', 'Begun', 'Outcome', 'On', 'Time', ''].map(
                  (head) => html`<th key=${head} scope="col">${head || html`<span class="hidden">Open</span>`}</th>`,
                )}
              </tr>
            </thead>
            <tbody>
              ${runs.map(
                ({
                  id,
                  title,
                  created,
                  state,
                  device,
                  seed,
                  duration: time,
                  tags,
                }) => html`<tr key=${id} data-test="a-run">
                  <td>
                    <input
                      type="checkbox"
                      checked=${ticked.includes(id)}
                      onChange=${() => tick(id)}
                      aria-label=${`Compare ${title}, ${when(created)}`}
                      data-test="tick"
                    />
                  </td>
                  <th scope="row">${title} ${tags.map((tag) => html`<span key=${tag} class="tag">${tag}</span> `)}</th>
                  <td>${when(created)}</td>
                  <td>${state}</td>
                  <td>${device}${seed == null ? '' : `, seed ${seed}`}</td>
                  <td>${duration(time)}</td>
                  <td>
                    <${Button}
                      kind="small"
                      onClick=${() => change({view: {open: view.open === id ? null : id}})}
                      aria-expanded=${view.open === id}
                      aria-label=${`${view.open === id ? 'Close' : 'Open'} ${title}`}
                      data-test="open-run"
                    >
                      ${view.open === id ? 'close' : 'open'}
                    <//>
                    <${Button}
                      kind="small"
                      onClick=${() => toData(id)}
                      aria-label=${`${title} to the page Data`}
                      data-test="to-data"
                    >
                      to Data
                    <//>
                  </td>
                </tr>`,
              )}
            </tbody>
          </table>
        </div>
        <p class="row">
          <${Button} onClick=${() => change({view: {compare: 'yes'}})} disabled=${!ticked.length} data-test="compare">
            Compare ${ticked.length || ''} ticked
          <//>
        </p>
      `
    }
    <${Refusal} text=${note} role="alert" />
    ${caveats.map((line) => html`<p key=${line} class="hint">${line}</p>`)}
    ${
      view.open &&
      html`<div class="lab-opened" data-test="opened-run">
        <${Failure} failure=${opened.failure} />
        ${opened.content && html`<${Shown} answer=${opened.content} of=${view.open} />`}
      </div>`
    }
    ${
      view.compare &&
      html`
        <${Failure} failure=${compared.failure} />
        ${compared.content && html`<${Compared} compared=${compared.content} rig=${rig} />`}
      `
    }
  <//>`;
}
