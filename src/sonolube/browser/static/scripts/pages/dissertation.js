/** Page Dissertation: its claims judged, every published number beside the computed one, corrections, figures. */
import {html, useEffect, useRef, useState} from '../../vendor/htm-preact-3.1.1.js';
import {TextTable} from '../answer.js';
import {callTask} from '../api.js';
import {short} from '../chart-scale.js';
import {NOTHING} from '../fields.js';
import {isActive, JobState, useJob} from '../job.js';
import {Button, fileOf, Loading, Refusal, Section, Select, Sheet, words} from '../parts.js';
import {addressOf, change, settle, useApp} from '../state.js';

/**
 * @import {FieldEvent} from '../parts.js'
 * @import {Texts} from '../state.js'
 * @typedef {{id: string, statement: string, verdict: string, claimed: string, found: string, source: string, judged:
 *   string, decisive_rows: string[], supporting_rows: string[]}} Claim
 * @typedef {{id: string, source: string, quantity: string, printed: string, unit: string, computed: number|null,
 *   relative_error: number|null, verdict: string, kind: string, note: string, [name: string]: any, alternatives:
 *   Record<string, {computed: number, reproduced: boolean, note: string}>}} ResultRow
 * @typedef {Record<'table'|'erratum'|'column'|'printed'|'corrected'|'evidence', string> & {row: number|null}}
 *   Correction
 */

const LABEL = 'Reproduction of the dissertation';
const MOST = 60; // rows shown before all are asked for
const HEADS = ['Row', 'Source', 'Quantity', 'Published', 'Computed', 'Difference', 'Verdict', 'Note'];
const FILTERS = [
  ['chapter', 'Chapter'],
  ['verdict', 'Verdict'],
  ['kind', 'Class'],
];

/** @param {{of: string}} props */
const Verdict = ({of}) => html`<span class=${`verdict is-${of.replaceAll(' ', '_')}`}>${words(of)}</span>`;

/**
 * Links to rows by their ids.
 * @param {{ids: string[], title: string}} props
 */
const RowLinks = ({ids, title}) =>
  ids.length
    ? html`<p class="hint">
      ${title}: ${ids.map(
        (id, place) => html`
          ${place > 0 && ', '}
          <a key=${id} href=${addressOf('dissertation', {row: id})}>
            ${id}
          </a>
        `,
      )}
    </p>`
    : null;

/**
 * Scorecard: each claim with its verdict, and what it rests on.
 * @param {{claims: Claim[]}} props
 */
const Claims = ({claims}) => html`<${Section} id="claims-title" title="Claims">
  <ul class="claims" data-test="claims">
    ${claims.map(
      (claim) => html`<li key=${claim.id} class="card" data-test=${`claim:${claim.id}`}>
        <div class="claim-head"><h3>${claim.statement}</h3><${Verdict} of=${claim.verdict} /></div>
        <p>Claimed ${claim.claimed}; found ${claim.found}. <span class="hint">${claim.source}</span></p>
        <details>
          <summary>How it is judged</summary>
          <p>${claim.judged}</p>
          <${RowLinks} title="Decisive rows" ids=${claim.decisive_rows} />
          <${RowLinks} title="Supporting rows" ids=${claim.supporting_rows} />
        </details>
      </li>`,
    )}
  </ul>
<//>`;

/**
 * Rows that the view asks for.
 * @param {ResultRow[]} rows
 * @param {Texts} view
 */
function filtered(rows, view) {
  const search = (view.search ?? '').toLowerCase().split(/\s+/).filter(Boolean);
  return rows.filter(
    (row) =>
      FILTERS.every(([name]) => !view[name] || String(row[name]) === view[name]) &&
      search.every((word) =>
        [row.id, row.source, words(row.quantity), row.note, row.printed].some((text) =>
          String(text).toLowerCase().includes(word),
        ),
      ),
  );
}

/** @param {{rows: ResultRow[], view: Texts, count: number}} props */
function Filters({rows, view, count}) {
  /** @param {string} name */
  const choices = (name) => [
    ['', 'all'],
    ...[...new Set(rows.map((row) => String(row[name])))].sort().map((each) => [each, words(each)]),
  ];
  /** @param {string} name @returns {(event: FieldEvent) => void} */
  const set = (name) => (event) => change({view: {[name]: event.target.value || null, row: null}});
  /** @param {FieldEvent} event */
  const search = (event) => change({view: {search: event.target.value || null, row: null}}, {replace: true});
  return html`<div class="filters" role="search" aria-label="Rows">
    <div>
      <label for="row-search">Search</label>
      <input
        type="text"
        id="row-search"
        value=${view.search ?? ''}
        onInput=${search}
        onBlur=${settle}
        onChange=${settle}
        autocomplete="off"
        maxlength="200"
        data-test="row-search"
      />
    </div>
    ${FILTERS.map(
      ([name, label]) => html`<div key=${name}>
        <label for=${`row-${name}`}>${label}</label>
        <${Select}
          id=${`row-${name}`}
          choices=${choices(name)}
          value=${view[name] ?? ''}
          onChange=${set(name)}
          data-test=${`row-filter:${name}`}
        />
      </div>`,
    )}
    <p role="status" data-test="row-count">${count} of ${rows.length} rows</p>
  </div>`;
}

/**
 * What other models give for the number of a row.
 * @param {{of: ResultRow}} props
 */
function Alternatives({of}) {
  const found = Object.entries(of.alternatives);
  if (!found.length) return null;
  return html`<details>
    <summary>${found.length === 1 ? '1 other model' : `${found.length} other models`}</summary>
    <ul>
      ${found.map(
        ([name, each]) => html`<li key=${name}>
          ${words(name)}: ${short(each.computed)} ${of.unit}
          ${each.reproduced ? ', reproduced' : ''}. ${each.note}
        </li>`,
      )}
    </ul>
  </details>`;
}

/** @param {string} id */
const rowId = (id) => `row-${id.replaceAll(/[^\w]/g, '-')}`;

/** @param {{rows: ResultRow[], view: Texts}} props */
function Rows({rows, view}) {
  const [isAll, setAll] = useState(false);
  const found = filtered(rows, view);
  const {row: wanted} = view;
  const shown = isAll || (wanted && found.findIndex((row) => row.id === wanted) >= MOST) ? found : found.slice(0, MOST);
  useEffect(() => {
    if (!wanted) return;
    const place = document.getElementById(rowId(wanted));
    place?.scrollIntoView({block: 'center'});
    place?.focus({preventScroll: true});
  }, [wanted, rows]);
  return html`<${Section} id="rows-title" title="Numbers">
    <${Filters} rows=${rows} view=${view} count=${found.length} />
    <div class="table-frame card" tabindex="0" role="group" aria-label="Published and computed numbers">
      <table class="table result-rows" data-test="rows">
        <thead><tr>${HEADS.map((head) => html`<th key=${head} scope="col">${head}</th>`)}</tr></thead>
        <tbody>
          ${shown.map(
            (row) => html`<tr
              key=${row.id}
              id=${rowId(row.id)}
              tabindex="-1"
              class=${row.id === wanted ? 'is-shown' : ''}
              data-test=${`row:${row.id}`}
            >
              <th scope="row"><a href=${addressOf('dissertation', {...view, row: row.id})}>${row.id}</a></th>
              <td>${row.source}</td>
              <td>${words(row.quantity)}</td>
              <td>${[row.printed, row.unit].filter(Boolean).join(' ')}</td>
              <td>${row.computed === null ? '–' : short(row.computed)}</td>
              <td>
                ${
                  row.relative_error === null
                    ? '–'
                    : `${row.relative_error > 0 ? '+' : ''}${short(100 * row.relative_error, 2)} %`
                }
              </td>
              <td><${Verdict} of=${row.verdict} /><br /><span class="hint">${words(row.kind)}</span></td>
              <td class="row-note">${row.note}<${Alternatives} of=${row} /></td>
            </tr>`,
          )}
        </tbody>
      </table>
    </div>
    ${
      shown.length < found.length &&
      html`<${Button} onClick=${() => setAll(true)} data-test="all-rows">Show all ${found.length} rows<//>`
    }
  <//>`;
}

/** Corrections of single cells of the published tables, read when they are opened. */
function Errata() {
  const [found, setFound] = useState(/** @type {Correction[]|null} */ (null));
  const isAsked = useRef(false);
  /** @param {{target: HTMLDetailsElement}} event */
  const read = async (event) => {
    if (!event.target.open || isAsked.current) return;
    isAsked.current = true;
    const {content} = await callTask('published', {});
    /** @type {({id: string, corrections: Omit<Correction, 'table'>[]}|undefined)[]} */
    const tables = [];
    for (const table of Object.keys(content?.answer ?? {}))
      tables.push((await callTask('published', {table})).content?.answer);
    setFound(tables.flatMap((table) => table?.corrections.map((each) => ({...each, table: table.id})) ?? []));
  };
  return html`<${Section} id="errata-title" title="Errata">
    <details onToggle=${read} data-test="errata">
      <summary>Corrections of the printed tables, with their evidence</summary>
      ${!found && html`<${Loading}>Reading the tables…<//>`}
      ${
        found &&
        html`<${TextTable}
          label="Corrections"
          kind="table-frame card"
          heads=${['Table', 'Erratum', 'Column', 'Printed', 'Corrected', 'Evidence']}
          rows=${found.map((each) => [
            each.table,
            each.erratum,
            `${words(each.column)}${each.row === null ? '' : `, row ${each.row + 1}`}`,
            each.printed,
            each.corrected,
            each.evidence,
          ])}
        />`
      }
    </details>
  <//>`;
}

/** @param {{job: import('../job.js').Job, files: string[]}} props */
function Figures({job, files}) {
  const names = files.filter((name) => name.endsWith('.svg'));
  /** @param {string} name */
  const title = (name) => words(name.replace(/^.*\/|\.svg$/g, '').replaceAll('-', ' '));
  if (!names.length) return null;
  return html`<${Section} id="figures-title" title="Figures">
    <div class="figures" data-test="figures">
      ${names.map(
        (name) => html`<figure key=${name} aria-label=${title(name)}>
          <img
            src=${fileOf(job.id, name)}
            alt=${`${title(name)}; its numbers are among the rows above`}
            loading="lazy"
          />
          <figcaption>
            ${title(name)} <a href=${fileOf(job.id, name)} download=${name.split('/').at(-1)}>SVG</a>
          </figcaption>
        </figure>`,
      )}
    </div>
    <p>
      <a href=${fileOf(job.id, 'reproduction.html')} download="reproduction.html">
        The whole report as one page (HTML)
      </a>
    </p>
  <//>`;
}

export default function Dissertation() {
  const {state} = useApp();
  const job = useJob('reproduce', NOTHING);
  const {content} = job;
  const isReady = job.job?.state === 'done' && content;
  /** @type {{caveats: string[], verdicts: Record<string, number>}} */
  const {caveats, verdicts} = isReady ? content.answer : {caveats: [], verdicts: {}};
  return html`<${Sheet} title="Dissertation">
    <p>Every published number of the dissertation beside the computed one, its claims judged by them.</p>
    ${
      !isReady &&
      !isActive(job.job) &&
      !job.isSought &&
      job.job?.state !== 'done' &&
      html`<p class="row">
        <${Button} kind="button is-main" onClick=${() => job.start(LABEL)} data-test="start-job">Compute<//>
        <span class="hint">Takes some minutes, once; the result stays on this computer.</span>
      </p>`
    }
    ${!isReady && (job.isSought || job.job?.state === 'done') && html`<${Loading}>Reading the result…<//>`}
    ${job.job && html`<${JobState} job=${job.job} cancel=${job.cancel} />`}
    <${Refusal} text=${job.failure?.text} role="alert" />
    ${
      isReady &&
      html`
        <p class="hint" data-test="verdicts">
          ${content.answer.count} numbers: ${Object.entries(verdicts)
            .filter(([, count]) => count)
            .map(([name, count]) => `${count} ${words(name)}`)
            .join(', ')}. sonolube ${content.answer.version}.
        </p>
        ${caveats.map((line) => html`<p key=${line} class="notice is-warning">${line}</p>`)}
        <${Claims} claims=${content.answer.claims} />
        <${Rows} rows=${content.answer.rows} view=${state.view} />
      `
    }
    <${Errata} />
    ${isReady && html`<${Figures} job=${job.job} files=${content.files ?? []} />`}
  <//>`;
}
