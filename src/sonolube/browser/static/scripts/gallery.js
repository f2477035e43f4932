/** Gallery of the example rigs: a small picture of each with its answer in a sentence; a press makes it the rig. */
import {html, useEffect, useRef, useState} from '../vendor/htm-preact-3.1.1.js';
import {ask} from './api.js';
import {Failure} from './answer.js';
import {Button, Loading} from './parts.js';
import {chooseRig} from './rig-panel.js';
import {rigNow} from './state.js';

/** @typedef {{name: string, title: string, text: string}} Example */

const FOLDER = 'static/examples';

/** @param {{onClose: () => void}} props */
export default function Gallery({onClose}) {
  const dialog = useRef(null);
  const [reply, setReply] = useState(/** @type {import('./api.js').Reply|null} */ (null));
  useEffect(() => {
    dialog.current.showModal();
    ask(`${FOLDER}/examples.json`).then(setReply);
  }, []);
  /** @param {string} name */
  const choose = (name) => {
    dialog.current.close();
    chooseRig(name);
  };
  /** @type {Example[]} */
  const examples = reply?.content ?? [];
  return html`<dialog
    class="gallery"
    ref=${dialog}
    onClose=${onClose}
    onClick=${(event) => event.target === dialog.current && dialog.current.close()}
    aria-labelledby="gallery-title"
    data-test="gallery"
  >
    <div class="gallery-head">
      <h2 id="gallery-title">Examples</h2>
      <${Button} kind="icon" onClick=${() => dialog.current.close()} aria-label="Close" data-test="close-gallery">
        <svg viewBox="0 0 16 16" width="16" height="16" aria-hidden="true">
          <path d="M3 3 13 13 M13 3 3 13" stroke="currentColor" stroke-width="1.8" stroke-linecap="round" />
        </svg>
      <//>
    </div>
    <p class="hint">Friction with vibration over that without, over the amplitude; the point is that of the rig.</p>
    ${!reply && html`<${Loading}>Reading the examples…<//>`}
    ${reply?.failure && html`<${Failure} failure=${reply.failure} />`}
    <ul class="examples">
      ${examples.map(
        ({name, title, text}) => html`<li key=${name}>
          <button
            type="button"
            class="example"
            onClick=${() => choose(name)}
            aria-current=${name === rigNow() ? 'true' : undefined}
            data-test=${`example:${name}`}
          >
            <img src=${`${FOLDER}/${name}.svg`} width="240" height="112" alt="" loading="lazy" />
            <strong>${title}</strong>
            <span class="hint">${text}</span>
          </button>
        </li>`,
      )}
    </ul>
  </dialog>`;
}
