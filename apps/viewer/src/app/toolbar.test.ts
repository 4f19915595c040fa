import { expect, it } from 'vitest';
import type { Command } from '../state/command-list.ts';
import { inlineCommands } from './toolbar.tsx';

const commands = ['open', 'frame', 'reset', 'flip', 'view', 'hud', 'save', 'help'].map(
  (name): Command => ({
    name: name as Command['name'],
    label: name,
    key: name[0],
    ...(['open', 'frame', 'view'].includes(name) && { word: name }),
  }),
);
const namesAt = (widthPx: number) => inlineCommands(commands, widthPx).map(({ name }) => name);

it('are those with a word on phones', () => {
  expect(namesAt(320)).toEqual(['open', 'frame', 'view']);
  expect(namesAt(430)).toEqual(['open', 'frame', 'view']);
});

it('are as many as fit, in their order, those with a word first', () => {
  expect(namesAt(431)).toEqual(['open', 'frame', 'reset', 'flip', 'view', 'hud']);
  expect(namesAt(560)).toEqual(commands.map(({ name }) => name));
  // Beside the figures there is less room.
  expect(namesAt(700)).toEqual(['open', 'frame', 'reset', 'flip', 'view', 'hud']);
});

it('are all on wide windows, where there is no menu', () => {
  expect(inlineCommands(commands, 1440)).toBe(commands);
});
