/**
 * Designs of an optimisation: a figure linked with its table both ways, and the one that is chosen set into the rig.
 */
import {html, useState} from '../../vendor/htm-preact-3.1.1.js';
import {Chart} from '../chart.js';
import {Button, Card, classes} from '../parts.js';
import {addressOf, change, useApp} from '../state.js';

/**
 * @import {Texts} from '../state.js'
 * @typedef {{objectives: Record<string, number>, frequency: {value: number}, changes: Texts}} DesignEntry
 * @typedef {{minimise: string, pareto: string, front: DesignEntry[], designs: DesignEntry[]}} Optimum
 */

const SAME = 1e-5; // relative distance within which a point is that of a design

/**
 * Place of a design in the linked figure: both objectives of a front, else one over the frequency in kHz.
 * @param {DesignEntry} design
 * @param {Optimum} answer
 */
const placeOf = ({objectives, frequency}, {minimise, pareto, front}) =>
  front.length
    ? {x: objectives[minimise], y: objectives[pareto]}
    : {x: 1e-3 * frequency.value, y: objectives[minimise]};

/** @param {number} one @param {number} other */
const isSame = (one, other) => Math.abs(one - other) <= SAME * Math.abs(other);

/**
 * @param {{content: Omit<import('../answer.js').Content, 'answer'> & {answer: Optimum}, linked?:
 *   import('../answer.js').Drawing, isDim: boolean, rig: import('../state.js').RigState}} properties `linked` is the
 *   figure with a point a design
 */
export function Front({content, linked, isDim, rig}) {
  const {
    state: {view},
  } = useApp();
  const {answer, blocks} = content;
  const [read, setRead] = useState(null); // number of the design under the pointer, or at the keys
  const [note, setNote] = useState('');
  const designs = answer.front.length ? answer.front : answer.designs;
  const {heads = [], rows = []} = blocks.find(({kind}) => kind === 'table') ?? {};
  const chosen = Math.min(Number(view.design) || 0, designs.length - 1);
  const places = designs.map((design) => placeOf(design, answer));
  /** @param {number|null} number */
  const choose = (number) => number !== null && change({view: {design: number ? String(number) : null}});
  /** @param {{x: number, y: number}|null} point */
  const onRead = (point) => {
    const number = point ? places.findIndex(({x, y}) => isSame(x, point.x) && isSame(y, point.y)) : -1;
    setRead(number < 0 ? null : number);
  };
  const use = () => {
    change({rig: {...rig, changes: {...rig.changes, ...designs[chosen].changes}}});
    setNote(`Design ${chosen + 1} is set into the rig.`);
  };
  return html`<${Card}
    id="designs-title"
    title=${answer.front.length ? 'Designs of the front' : 'Best designs'}
    isDim=${isDim}
  >
    ${
      linked &&
      html`<${Chart}
        ...${linked}
        dimmed=${isDim}
        onPick=${() => choose(read)}
        picks="chooses the design"
        onRead=${onRead}
        ringed=${places[read ?? chosen]}
      />`
    }
    <div class="table-frame" tabindex="0" role="group" aria-label="Designs">
      <table class="table" data-test="designs-table">
        <thead>
          <tr>
            <th scope="col">chosen</th>
            ${heads.map((head) => html`<th key=${head} scope="col">${head}</th>`)}
          </tr>
        </thead>
        <tbody>
          ${rows.map(
            (row, number) => html`<tr
              key=${number}
              class=${classes('design', {'is-read': number === read, 'is-chosen': number === chosen})}
              onPointerEnter=${() => setRead(number)}
              onPointerLeave=${() => setRead(null)}
              onClick=${() => choose(number)}
              data-test=${`row:${number}`}
            >
              <td>
                <input
                  type="radio"
                  name="design"
                  checked=${number === chosen}
                  onChange=${() => choose(number)}
                  onFocus=${() => setRead(number)}
                  onBlur=${() => setRead(null)}
                  aria-label=${`Design ${number + 1}: ${row.join(', ')}`}
                  data-test=${`design:${number}`}
                />
              </td>
              ${row.map((cell, place) => html`<td key=${place}>${cell}</td>`)}
            </tr>`,
          )}
        </tbody>
      </table>
    </div>
    <div class="row">
      <${Button} kind="button is-main" onClick=${use} disabled=${isDim} data-test="use-design">
        Use design ${chosen + 1}
      <//>
      <span class="hint">Sets ${Object.keys(designs[chosen].changes).join(', ')}.</span>
      <span role="status" class="status" data-test="used">
        ${note && html`${note} <a href=${addressOf('predict')}>Predict with it</a>`}
      </span>
    </div>
  <//>`;
}
