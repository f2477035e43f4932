/**
 * Table of own runs in the folder of the rig that the workbench was opened with: read at the start, written at each
 * change. What the view has is always that of the folder.
 */
import {ask} from './api.js';
import {amend, entryNow, onStep, rigNow} from './state.js';

/** Name of the rig whose folder is open; empty for none. */
let folder = '';
/** Entry of the view for what the file holds, and the state of the file. */
let kept = {entry: '', state: ''};

/** Whether the rig of now is that of the folder. */
export const isInFolder = () => Boolean(folder) && rigNow() === folder;

/** Entry of the view for the table of the folder; empty for one without a run. */
export const folderEntry = () => kept.entry;

/** Upload of an entry of the view. @param {string} entry */
const uploadOf = (entry) => ({upload: entry.split(' ')[0], name: 'runs.csv'});

/** Read the table of the folder; why that was refused. @returns {Promise<string>} */
export async function readFolder() {
  const {content, failure} = await ask('api/folder-runs', {body: {}});
  if (failure) return failure.text;
  const made = content.csv ? await ask('api/uploads', {raw: new Blob([content.csv])}) : null;
  if (made?.failure) return made.failure.text;
  kept = {entry: made ? `${made.content.upload} runs.csv` : '', state: content.state};
  followFolder();
  return '';
}

/**
 * Write a table to the folder, where the rig of now is that of one; why that was refused.
 * @param {string} entry of the view; empty for a table without a run
 * @returns {Promise<string>}
 */
export async function keep(entry) {
  if (!isInFolder() || entry === kept.entry) return '';
  const body = {keep: entry ? uploadOf(entry) : null, state: kept.state};
  const {content, failure} = await ask('api/folder-runs', {body});
  if (failure) return failure.text;
  kept = {entry, state: content.state};
  return '';
}

/** Make the table of the folder that of the view. */
export const followFolder = () =>
  isInFolder() && (entryNow('runs') ?? '') !== kept.entry && amend({runs: kept.entry || null});

/** @param {string} name of the rig whose folder is open */
export async function openFolder(name) {
  folder = name;
  onStep(async ({view, rig}) => {
    if (rig.name === folder && view.runs && (await keep(view.runs))) view.runs = kept.entry;
  });
  await readFolder();
}
