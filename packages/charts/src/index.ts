export { frameFacts, passTable, type TimeRow, timeNotes, timeRows, timeTable } from './frame-tables.ts';
export { boxAround, type LabelBox, LabelSpace } from './label-space.ts';
export { alignedColumns } from './text-table.ts';
