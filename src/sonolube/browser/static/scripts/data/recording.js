/** A recording: its channels over time, what is measured of it, and where that goes. */
import {html} from '../../vendor/htm-preact-3.1.1.js';
import {Blocks, Caveats, Failure} from '../answer.js';
import {Card} from '../parts.js';
import {mappingOf, useMeasured} from './files.js';

/** What measures a recording. @param {import('./files.js').DataFile} file @param {object} own @returns {import('./files.js').Asked} */
export const taskOf = (file, own) => ({task: 'measure friction', args: {files: file, ...mappingOf(own.mapping)}});

export default function Recording({file, own}) {
  const {content, failure} = useMeasured(file, taskOf(file, own));
  return html`<${Card} id="recording-title" title=${file.name}><${Failure} failure=${failure} />
    ${content && html`<${Blocks} blocks=${content.blocks} /><${Caveats} answer=${content} isMoving=${false} of=${file.upload} hasFields=${false} />`}<//>`;
}
