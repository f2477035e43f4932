/** Files of answers and jobs to take away. */
import {html, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {Button, Card, fileOf} from '../parts.js';
import {save} from '../take-away.js';

/**
 * Buttons that save files of an answer: the report, all in an archive, or that whose name ends so.
 * @param {{task: string, args: object, files: [string, string][], isOff: boolean}} properties
 */
export function Saves({task, args, files, isOff}) {
  const [note, setNote] = useState('');
  /** @param {string} label @param {string} which */
  const take = async (label, which) => {
    setNote(`${label}: being made…`);
    const more = which === 'report' ? {form: which} : which === 'all' ? {} : {ending: which};
    const {content, failure} = await ask(which === 'report' ? 'api/take' : 'api/files', {
      body: {task, arguments: args, ...more},
    });
    if (content) save(content);
    setNote(failure ? failure.faults[0]?.text || failure.text : `${content.name}: saved.`);
  };
  return html`<${Card} id="saves" title="To take away">
    <div class="row">
      ${files.map(
        ([label, which]) => html`<${Button}
          key=${label}
          disabled=${isOff}
          onClick=${() => take(label, which)}
          data-test=${`save:${which}`}
        >
          ${label}
        <//>`,
      )}
      <span class="hint" role="status" data-test="save-note">${note}</span>
    </div>
  <//>`;
}

/**
 * Files of a job that is done, as links.
 * @param {{job: import('../job.js').Job|null, files: string[]}} props
 */
export const JobFiles = ({job, files}) =>
  job?.state === 'done'
    ? html`<${Card} id=${`files-${job.id}`} title="Files">
      <ul class="row" data-test="job-files">
        ${files.map(
          (name) =>
            html`<li key=${name}>
              <a
                class="button"
                href=${fileOf(job.id, name)}
                download=${name.split('/').at(-1)}
                data-test=${`file:${name}`}
              >
                ${name}
              </a>
            </li>`,
        )}
      </ul>
    <//>`
    : null;
