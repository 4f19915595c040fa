import { describe, expect, test } from 'vitest';
import { COMMANDS } from '../state/command-list.ts';
import { findCommands, OTHER_WORDS } from './help.tsx';

describe('commands are found', () => {
  test.each([
    ...[
      ['video', 'save'],
      ['screenshot', 'save'],
      ['picture', 'save'],
      ['png', 'save'],
      ['export', 'save'],
      ['download', 'save'],
      ['embed', 'save'],
      ['undo', 'undo'],
      ['histogram', 'inspect'],
      ['opacity', 'inspect'],
      ['remove', 'select'],
      ['delete', 'select'],
      ['crop', 'crop'],
      ['measure', 'measure'],
      ['full screen', 'view'],
      ['field of view', 'view'],
      ['fov', 'view'],
      ['background', 'view'],
      ['orthographic', 'view'],
      ['saved views', 'view'],
      ['theme', 'theme'],
      ['dark', 'theme'],
      ['depth', 'mode'],
      ['overdraw', 'mode'],
      ['zoom', 'frame'],
      ['memory', 'hud'],
      ['fps', 'hud'],
      ['error', 'accuracy'],
      ['psnr', 'accuracy'],
      ['preset', 'accuracy'],
      ['quality', 'accuracy'],
      ['settings', 'accuracy'],
      ['share', 'save'],
      ['annotation', 'annotate'],
      ['note', 'annotate'],
      ['fog', 'effects'],
      ['lasso', 'select'],
      ['erase', 'select'],
      ['cut', 'crop'],
      ['ruler', 'measure'],
      ['distance', 'measure'],
      ['lens', 'view'],
      ['bookmark', 'view'],
      ['rotate', 'flip'],
      ['upside down', 'flip'],
      ['orbit', 'outside'],
      ['room', 'inside'],
      ['first person', 'walk'],
      ['drone', 'fly'],
      ['layers', 'clouds'],
      ['merge', 'add'],
      ['import', 'open'],
      ['load', 'open'],
      ['url', 'open'],
      ['sample', 'open'],
      ['recent', 'open'],
      ['history', 'undo'],
      ['redo', 'redo'],
      ['restore', 'bring-back'],
      ['pin', 'annotate'],
      ['comment', 'annotate'],
      ['home', 'reset'],
      ['fit', 'frame'],
      ['statistics', 'hud'],
      ['performance', 'hud'],
      ['gif', 'save'],
      ['html', 'save'],
      ['iframe', 'save'],
      ['publish', 'save'],
      ['convert', 'save'],
      ['shortcuts', 'help'],
      ['keyboard', 'help'],
      ['wireframe', 'mode'],
      ['heat map', 'mode'],
      ['brightness', 'effects'],
      ['ellipsoids', 'mode'],
    ],
  ])('by the everyday word “%s”: %s', (query, name) => {
    expect(findCommands(query).map((each) => each.name)).toContain(name);
    expect(findCommands(` ${query.toUpperCase()} `).map((each) => each.name)).toContain(name);
  });

  test('by their labels before other words, all of them without a word, none by nonsense', () => {
    expect(findCommands('delete')[0].name).toBe('select');
    expect(findCommands('walk').map(({ name }) => name)).toEqual(['walk']);
    expect(findCommands('link')[0].name).toBe('link');
    expect(findCommands('')).toEqual(COMMANDS);
    expect(findCommands('xyzzy')).toEqual([]);
  });

  test('by keys of their own; other words are in lower case', () => {
    for (const words of Object.values(OTHER_WORDS)) expect(words).toBe(words.toLowerCase());
    expect(new Set(COMMANDS.map(({ key }) => key)).size).toBe(COMMANDS.length);
  });
});
