import type { Command } from '../state/command-list.ts';

/** On narrower windows the toolbar has only commands with a word of their own. */
const WORDS_WIDTH_PX = 430;
/** Up to this width the toolbar is as wide as the window; wider ones leave room for the figures. */
const WHOLE_WIDTH_PX = 640;
const FIGURES_PX = 320;
const MARGINS_PX = 24;
/** A button with the gap beside it, large enough for a finger. */
const BUTTON_PX = 46;
/** Width of the word beside the first button's icon. */
const WORD_PX = 50;

/**
 * The commands whose buttons fit into the toolbar, in their order; the others are in its menu.
 * Those with a word of their own go first.
 */
export function inlineCommands<Each extends Command>(
  commands: readonly Each[],
  windowWidthPx: number,
): readonly Each[] {
  const worded = commands.filter(({ word }) => word !== undefined);
  if (windowWidthPx <= WORDS_WIDTH_PX) return worded;
  const leftPx = windowWidthPx - (windowWidthPx <= WHOLE_WIDTH_PX ? MARGINS_PX : FIGURES_PX) - WORD_PX;
  const fitting = Math.floor(leftPx / BUTTON_PX);
  if (commands.length <= fitting) return commands;
  const others = commands.filter(({ word }) => word === undefined);
  // One place is the menu's.
  const kept = new Set([...worded, ...others.slice(0, Math.max(0, fitting - 1 - worded.length))]);
  return commands.filter((command) => kept.has(command));
}
