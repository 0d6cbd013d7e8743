// Plays a suite's capsules on the visitor's GPU, has each scene judged, and offers the report. It stands in one module with
// player.mjs and visitor.mjs: a page that is opened from a disk can import nothing.

const $ = (id) => document.getElementById(id);
const data = JSON.parse($('data').textContent);
const total = data.scenes.reduce((sum, scene) => sum + scene.cases.length, 0);

/** An element; children that are strings become text, never markup. */
function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children.filter((child) => child !== null));
  return node;
}

/** The bytes that a script element holds, packed. */
async function unpacked(id) {
  const packed = Uint8Array.from(atob($(id).textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The judge in its worker; one question at a time. */
class Judge {
  constructor(program) {
    this.worker = new Worker(URL.createObjectURL(new Blob([$('worker').textContent], { type: 'text/javascript' })));
    this.worker.postMessage({ program });
  }

  /** The verdict on a request, of which `files` are paths and bytes. */
  ask(request, files = []) {
    const list = files.map(([path, bytes]) => [path, bytes.length]);
    const whole = { suite: data.suite, shard: data.shard, ...request, files: list };
    const parts = [JSON.stringify(whole), '\n', ...files.map(([, bytes]) => bytes)];
    return new Promise((resolve, reject) => {
      this.worker.onmessage = ({ data }) => (data.error ? reject(new Error(data.error)) : resolve(data.verdict));
      this.worker.onerror = (event) => reject(new Error(event.message));
      new Blob(parts).arrayBuffer().then((buffer) => {
        this.worker.postMessage({ request: new Uint8Array(buffer) }, [buffer]);
      }, reject);
    });
  }
}

/** Who draws here, as a request says it. */
async function drawer() {
  try {
    if (!navigator.gpu) throw new Error('this browser has no WebGPU');
    return { host: { host: await host(navigator.gpu, compiler()), platform: platform() } };
  } catch (error) {
    return { absent: { why: error.message } };
  }
}

/** The files of a capsule's answer, each below `folder`. */
async function answer(capsule, contents, folder) {
  const files = new Map(capsule.map(([name, place]) => [name, contents[place]]));
  const read = async (name) => {
    if (!files.has(name)) throw new Error(`${name} is not among the files`);
    return files.get(name);
  };
  const found = await play(navigator.gpu, read, compiler());
  return [...found].map(([name, bytes]) => [`${folder}/${name}`, bytes]);
}

/** A scene's pictures and all files, the capsules' and the answers', as a request has them. */
async function drawn(scene, contents) {
  const pictures = [];
  const files = [];
  for (const [k, { options, files: own }] of scene.cases.entries()) {
    const picture = { options, capsule: `${k}/capsule`, answer: null, failure: null };
    for (const [name, place] of own) files.push([`${k}/capsule/${name}`, contents[place]]);
    try {
      files.push(...(await answer(own, contents, `${k}/answer`)));
      picture.answer = `${k}/answer`;
    } catch (error) {
      picture.failure = error.message;
    }
    pictures.push(picture);
  }
  return [{ scene: scene.name, pictures }, files];
}

const WORDS = { agree: 'agrees', differ: 'differs', partial: 'not judged' };

function percent(share) {
  return share > 0 && share < 0.001 ? '< 0.1 %' : `${(100 * share).toFixed(1)} %`;
}

function line(row) {
  const bar = element('b', { style: `width: ${Math.min(100, 100 * row.share)}%` });
  return [
    element('td', {}, row.technique, row.scheme === 'general' ? ' (general)' : null),
    element('td', {}, element('span', { class: `badge ${row.verdict}` }, WORDS[row.verdict]),
      ...row.why.map((why) => element('div', { class: 'reason' }, why))),
    element('td', { class: 'number' }, row.covered.toLocaleString('en')),
    element('td', { class: 'number' }, row.differing.toLocaleString('en')),
    element('td', {}, element('div', { class: 'share' }, element('i', {}, bar), element('span', {}, percent(row.share)))),
  ];
}

/** Lists the cases of a scene: a line each, the scene's name and picture beside those of one view. */
function list(rows) {
  const views = Map.groupBy(rows, ({ viewpoint }) => viewpoint);
  for (const [viewpoint, rows] of views) {
    const body = element('tbody');
    const { scene, picture } = rows.find(({ picture }) => picture) ?? rows[0];
    const { stresses } = data.scenes.find(({ name }) => name === scene);
    const text = element('span', {}, scene, element('small', {}, stresses), element('small', {}, viewpoint));
    const image = picture ? element('img', { src: picture, alt: '' }) : null;
    const head = element('th', { scope: 'rowgroup', class: 'scene', rowspan: rows.length }, element('div', {}, image, text));
    for (const [k, row] of rows.entries()) body.append(element('tr', {}, ...(k === 0 ? [head] : []), ...line(row)));
    $('cases').append(body);
  }
}

/** Shows what is known so far. */
function show(verdict, isLast) {
  list(verdict.rows);
  const judged = verdict.report.cases.length;
  $('progress').value = judged / total;
  $('done').textContent = `${judged} of ${total}`;
  document.title = `${judged} of ${total}: Isophote`;
  $('verdict').className = `verdict ${isLast || verdict.state === 'differ' ? verdict.state : ''}`;
  $('verdict').replaceChildren(element('p', {}, verdict.line));
}

function save(report) {
  const name = report.subjects.at(-1).name.replace(/[^A-Za-z0-9]+/g, '-').toLowerCase();
  $('save').href = URL.createObjectURL(new Blob([JSON.stringify(report)], { type: 'application/json' }));
  $('save').download = `isophote-${name}.json`;
  $('save').hidden = false;
}

/** Facts of the adapter. */
function tell(facts) {
  for (const [name, value] of Object.entries(facts)) {
    $('adapter').append(element('div', {}, element('dt', {}, name), element('dd', {}, value || '—')));
  }
}

/** The last verdict, after each scene was drawn, judged and shown. */
async function all(drawnBy) {
  const [blob, program] = [await unpacked('files'), await unpacked('judge')];
  let end = 0;
  const contents = data.files.map((length) => blob.subarray(end, (end += length)));
  const judge = new Judge(program);
  if (!drawnBy.host) return judge.ask({ drawnBy });
  // Where the measurement fails the pictures will, too, and say why.
  const edges = await answer(data.edges, contents, 'edges').catch(() => null);
  const first = await judge.ask({ drawnBy, edges: edges && 'edges' }, edges ?? []);
  tell({ 'Grid of corners': first.grid ?? 'none found' });
  let verdict = first;
  for (const scene of data.scenes) {
    // The next scene is drawn while this one is judged.
    const [request, files] = await drawn(scene, contents);
    const before = await verdict;
    show(before, false);
    verdict = judge.ask({ ...request, drawnBy, report: before.report, movesPx: first.movesPx }, files);
  }
  return verdict;
}

const drawnBy = await drawer();
tell(drawnBy.host
  ? { Adapter: drawnBy.host.host.adapter, Driver: drawnBy.host.host.driver, Browser: drawnBy.host.host.compiler, System: drawnBy.host.platform }
  : { Adapter: `none: ${drawnBy.absent.why}`, Browser: compiler(), System: platform() });
const part = data.shard.count > 1 ? `, part ${data.shard.index} of ${data.shard.count}` : '';
$('facts').textContent = `Suite ${data.suite}${part} · ${total} pictures · program ${data.program}`;
$('start').addEventListener('click', async () => {
  $('start').disabled = true;
  $('progress').hidden = false;
  document.body.dataset.state = 'running';
  try {
    const verdict = await all(drawnBy);
    show(verdict, true);
    save(verdict.report);
    document.body.dataset.state = 'done';
  } catch (error) {
    $('verdict').className = 'verdict partial';
    $('verdict').replaceChildren(element('p', {}, `The judge failed: ${error.message}`));
    document.body.dataset.state = 'failed';
  }
  $('progress').hidden = true;
});
