import { expect, test } from 'vitest';
import { HARD_CASES } from './catalogue.ts';
import { chooseCases } from './choose-cases.ts';

test('cases are chosen by name, and a name that none has is refused', () => {
  const [first, second] = HARD_CASES;
  expect(chooseCases([second.name, first.name])).toEqual([first, second]);
  const chooseWrong = () => chooseCases([first.name, 'scale-unti', '']);
  expect(chooseWrong).toThrow('There is no hard case “scale-unti”, “”.');
  expect(chooseWrong).toThrow(expect.objectContaining({ argument: 'cases' }));
});
