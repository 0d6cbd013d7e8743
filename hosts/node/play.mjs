// node play.mjs CAPSULE --out ANSWER [--adapter NAME]: plays a capsule by Dawn, whose compiler is Tint.

import { mkdir, readFile, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { create, globals } from 'webgpu';
import { play } from '../player.mjs';

Object.assign(globalThis, globals);

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: { out: { type: 'string' }, adapter: { type: 'string' } },
});
if (positionals.length !== 1 || !values.out) {
  console.error('usage: node play.mjs CAPSULE --out ANSWER [--adapter NAME]');
  process.exit(2);
}
const backend = { darwin: 'metal', win32: 'd3d12' }[process.platform] ?? 'vulkan';
const options = [`backend=${backend}`, ...(values.adapter ? [`adapter=${values.adapter}`] : [])];
try {
  const answer = await play(create(options), (name) => readFile(join(positionals[0], name)), 'tint');
  await mkdir(values.out, { recursive: true });
  // The document comes last: a folder that was cut off has none.
  for (const [name, bytes] of answer) await writeFile(join(values.out, name), bytes);
} catch (error) {
  console.error(error.message);
  process.exit(1);
}
process.exit(0);
