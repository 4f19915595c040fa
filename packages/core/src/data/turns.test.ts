import { expect, test } from 'vitest';
import { nextTask, Turns } from './turns.ts';

test('other tasks have their turns during long work', async () => {
  const turns = new Turns(undefined);
  let others = 0;
  const other = nextTask().then(() => others++);
  // Without end if it gave none.
  for (let i = 0; i < 1e7 && others === 0; i++) await turns.give();
  expect(others).toBe(1);
  await other;
});

test('an abort ends the work', async () => {
  const controller = new AbortController();
  const turns = new Turns(controller.signal);
  await turns.give();
  controller.abort('enough');
  await expect(turns.give()).rejects.toBe('enough');
});
