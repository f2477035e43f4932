/**
 * What the columns of a file hold: asked beside the file where it does not tell, kept as a mapping, remembered for its
 * headings.
 */
import {html, useEffect, useState} from '../../vendor/htm-preact-3.1.1.js';
import {ask} from '../api.js';
import {Labelled, refusedBy} from '../fields.js';
import {Button, FileButton, Refusal, Select} from '../parts.js';
import {stored} from '../state.js';
import {save} from '../take-away.js';

/** @param {import('./files.js').Info} info */
const storeOf = ({columns}) => `columns ${columns.map(({label}) => label).join('|')}`;

/** @param {Omit<import('./files.js').FileProps, 'asked'>} props */
export function Columns({file, own, set, info}) {
  const {columns, quantities, reason} = info;
  const [drafts, setDrafts] = useState(/** @type {import('../state.js').Texts} */ ({}));
  const [rows, setRows] = useState(info.rows);
  const [rate, setRate] = useState('');
  const [failure, setFailure] = useState(/** @type {import('../api.js').Failure|undefined} */ (undefined));
  const isAsked = Boolean(reason) || columns.some((each) => each.is_asked);
  /** @param {import('./files.js').Column} column */
  const statementOf = ({label, statement}) => drafts[label] ?? statement;
  /** @param {string} key */
  const faultOf = (key) => failure?.faults.find((fault) => fault.key === key)?.text;
  /** @param {string} text */
  const isPlaced = (text) => columns.some((each) => each.label === text);
  /** @param {string} mapping */
  const keep = (mapping) => {
    stored('sessionStorage', storeOf(info), mapping);
    setDrafts({});
    set({mapping: mapping || null});
  };
  useEffect(() => {
    const last = isAsked && !own.mapping && stored('sessionStorage', storeOf(info));
    if (last) set({mapping: last});
  }, [file.upload]);
  const use = async () => {
    const {content, failure: fault} = await ask('api/file', {
      body: {
        file,
        mapping: own.mapping ?? '',
        columns: Object.fromEntries(columns.filter(({label}) => label).map((each) => [each.label, statementOf(each)])),
        rows: Object.fromEntries(Object.entries(rows).filter(([, cell]) => cell)),
        sample_rate: rate,
      },
    });
    setFailure(fault);
    if (content) keep(content.mapping);
  };
  if (!columns.length) return html`<${Refusal} text=${reason} role="alert" />`;
  return html`<details class="card" open=${isAsked} data-test="columns">
    <summary>Columns and units${isAsked && ' (asked)'}</summary>
    <${Refusal} text=${reason} role="alert" />
    <p class="hint">Quantity and unit of each column, such as friction_force N, or - to leave it out.</p>
    <datalist id="quantities">
      ${quantities.map(
        ([name, unit, meaning]) => html`<option key=${name} value=${`${name} ${unit}`.trim()}>${meaning}</option>`,
      )}
    </datalist>
    <div class="data-columns">
      ${columns
        .filter(({label}) => label)
        .map(
          (each, at) => html`<${Labelled}
            key=${each.label}
            id=${`column-${at}`}
            refusal=${faultOf(each.label)}
            label=${`${each.label} (${each.cells.join('; ') || 'empty'})`}
          >
            <input
              type="text"
              id=${`column-${at}`}
              list="quantities"
              value=${statementOf(each)}
              autocomplete="off"
              onInput=${(event) => setDrafts({...drafts, [each.label]: event.target.value})}
              data-test=${`column:${each.label}`}
              ...${refusedBy(`column-${at}`, faultOf(each.label))}
            />
            ${
              each.texts.length > 1 &&
              html`<${Select}
                aria-label=${`Rows in which ${each.label} is`}
                choices=${[['', 'all rows'], ...each.texts.map((text) => [text, text])]}
                value=${rows[each.label] ?? ''}
                onChange=${(event) => setRows({...rows, [each.label]: event.target.value})}
                data-test=${`rows:${each.label}`}
              />`
            }
          <//>`,
        )}
      ${
        info.kind === 'recording' &&
        !columns.some((each) => /^(time|revolutions)\b/.test(statementOf(each))) &&
        html`<${Labelled}
          id="sample-rate"
          label="Samples per second, without a column of the time"
          refusal=${faultOf('sample_rate')}
        >
          <input
            type="text"
            id="sample-rate"
            value=${rate}
            placeholder="1 kHz"
            onInput=${(event) => setRate(event.target.value)}
            data-test="sample-rate"
          />
        <//>`
      }
    </div>
    ${failure?.faults
      .filter(({key}) => !isPlaced(key) && key !== 'sample_rate')
      .map(({text}) => html`<${Refusal} key=${text} text=${text} role="alert" />`)}
    <p class="row">
      <${Button} kind="button is-main" onClick=${use} data-test="use-columns">Use these columns<//>
      <${Button}
        disabled=${!own.mapping}
        onClick=${() =>
          save({name: `${file.name.replace(/\.\w+$/, '')}-mapping.toml`, kind: 'application/toml', text: own.mapping})}
        data-test="save-mapping"
      >
        Save mapping
      <//>
      <${FileButton}
        accept=".toml"
        label="Mapping of columns"
        onFile=${async (given) => keep(await given.text())}
        test="mapping-file"
        data-test="load-mapping"
      >
        Load mapping…
      <//>
      ${own.mapping && html`<${Button} kind="button is-quiet" onClick=${() => keep('')}>As the file tells<//>`}
    </p>
  </details>`;
}
