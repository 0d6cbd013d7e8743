// Plays the capsule whose files were chosen, and offers the answer's files.

import { play } from '../player.mjs';
import { compiler } from './visitor.mjs';

const state = document.querySelector('#state');
const list = document.querySelector('#answer');

/** Plays the capsule of these files; the answer's files by name. */
async function draw(files) {
  if (!navigator.gpu) throw new Error('this browser has no WebGPU');
  const named = new Map([...files].map((file) => [file.name, file]));
  const read = async (name) => {
    if (!named.has(name)) throw new Error(`${name} is not among the files`);
    return new Uint8Array(await named.get(name).arrayBuffer());
  };
  return play(navigator.gpu, read, compiler());
}

function link(name, bytes) {
  const item = document.createElement('li');
  const anchor = document.createElement('a');
  anchor.href = URL.createObjectURL(new Blob([bytes]));
  anchor.download = name;
  anchor.textContent = `${name}, ${bytes.length} bytes`;
  item.append(anchor);
  return item;
}

document.querySelector('#capsule').addEventListener('change', async ({ target }) => {
  state.className = 'playing';
  state.textContent = 'Drawing …';
  list.replaceChildren();
  try {
    const answer = await draw(target.files);
    list.replaceChildren(...[...answer].map(([name, bytes]) => link(name, bytes)));
    state.className = 'drawn';
    state.textContent = 'Drawn.';
  } catch (error) {
    state.className = 'failed';
    state.textContent = error.message;
  }
});
