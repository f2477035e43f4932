/**
 * The stop button, on every page while a run is at work; where the workbench does not answer, the stop page of the
 * runner.
 */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {useConnection} from '../api.js';
import {classes, useEvents} from '../parts.js';
import {addressAsLeft} from '../state.js';
import {isAtWork, send, useLab} from './lab.js';

const PATIENCE = 4000; // ms; the workbench answers when the run has ended, or after 3 s

export default function Stop() {
  const run = useLab()?.run;
  const isGone = useConnection().connection !== 'ok';
  const [said, say] = useState('');
  useEffect(() => say(''), [run?.id]);
  const stop = async () => {
    say('Stop: asked for.');
    const {failure} = await send('stop', {}, {signal: AbortSignal.timeout(PATIENCE)});
    say(
      failure
        ? failure.kind === 'refused'
          ? failure.text
          : 'Stop: no answer. Use the stop page, or the emergency stop.'
        : 'Stop: on its way.',
    );
  };
  useEvents(['keydown'], (event) => {
    if (event.key !== '.' || !(event.ctrlKey || event.metaKey) || event.repeat || !isAtWork(run)) return;
    event.preventDefault();
    stop();
  });
  if (!run || !isAtWork(run)) return null;
  return html`<aside
    class=${classes('stop-bar', {'is-gone': isGone})}
    aria-label="Stop of the run"
    data-test="stop-bar"
  >
    <p role="alert" data-test="stop-text">
      ${
        isGone
          ? 'The workbench does not answer: this button stops nothing. Use the stop page, or the emergency stop.'
          : said
      }
    </p>
    <a href=${addressAsLeft('lab')} data-test="to-lab">
      ${run.prompt ? 'The run asks the operator' : `Run: ${run.state}`}
    </a>
    ${
      run.stop_link &&
      html`<a
        class=${isGone && 'stop'}
        href=${run.stop_link}
        target="_blank"
        rel="noopener noreferrer"
        data-test="stop-page"
      >
        Stop page
      </a>`
    }
    <button type="button" class="stop" onClick=${stop} aria-keyshortcuts="Control+." data-test="stop">
      <svg viewBox="0 0 20 20" width="24" height="24" aria-hidden="true">
        <path d="M6 1h8l5 5v8l-5 5H6l-5-5V6z" fill="currentColor" />
      </svg>Stop <kbd>Ctrl .</kbd>
    </button>
  </aside>`;
}
