import { expect, it } from 'vitest';
import { textOf } from './measure-tool.ts';

it('shows distances in the unit that is asked for', () => {
  expect(textOf(1.23456, {})).toBe('1.23');
  expect(textOf(1.23456, { name: 'm' })).toBe('1.23 m');
  expect(textOf(1.23456, { name: 'cm', perWorldUnit: 100, digits: 0 })).toBe('123 cm');
});
