// Draws every case with the packages of one checkout, into a folder: `node draw-cases.mjs OPTIONS`, which are JSON. Started
// by compare-checkouts.mjs, a process per checkout, always from the checkout that compares.
import { accuracy } from './cases/accuracy.mjs';
import { effects } from './cases/effects.mjs';
import { embedded } from './cases/embedded.mjs';
import { largeScene } from './cases/large-scene.mjs';
import { scenes } from './cases/scenes.mjs';
import { sequence } from './cases/sequence.mjs';
import { DrawnFolder } from './drawn-folder.mjs';
import { openCheckout } from './open-checkout.mjs';

/** By the first part of their cases' names. The cases of a group share what takes long to make. */
const GROUPS = { scenes, effects, accuracy, sequence, 'large-scene': largeScene, embedded };

const { folder, dawn, into, names, size, playbot } = JSON.parse(process.argv[2]);
const checkout = await openCheckout({ folder, dawn });
const drawn = new DrawnFolder(into);
for (const [group, draw] of Object.entries(GROUPS)) {
  if (!isWanted(group)) continue;
  const context = {
    checkout,
    size,
    playbot,
    test: (name, run) => runCase(`${group}/${name}`, run),
    note: (name, value) => drawn.note(`${group}/${name}`, value),
  };
  await draw(context).catch((error) => drawn.failed(group, messageOf(error)));
}
drawn.close({ adapter: checkout.adapterLabel, node: process.versions.node });
// Dawn's device would keep the process alive.
process.exit(0);

async function runCase(name, run) {
  if (!isWanted(name)) return;
  const record = {
    image: (part, image) => drawn.image(`${name}/${part}`, image),
    value: (part, value) => drawn.value(`${name}/${part}`, value),
    skipped: (reason) => drawn.skipped(name, reason),
  };
  const problems = [];
  await run(record).catch((error) => problems.push(messageOf(error)));
  problems.push(...(await checkout.takeErrors()));
  if (problems.length > 0) drawn.failed(name, problems.join('; '));
}

/** Whether `names` has this case, something that it draws, or the group it belongs to. */
function isWanted(name) {
  const isWithin = (part, whole) => part === whole || part.startsWith(`${whole}/`);
  return names.length === 0 || names.some((wanted) => isWithin(name, wanted) || isWithin(wanted, name));
}

function messageOf(error) {
  return error instanceof Error ? `${error.name}: ${error.message}` : String(error);
}
