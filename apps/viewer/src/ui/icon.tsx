/** Line drawings on a 20 × 20 grid, in the colour of the text around them. */
const PATHS = {
  open: 'M2.5 5.5v9.5a1 1 0 0 0 1 1h12l2-7.5h-12l-2 6.5M2.5 5.5a1 1 0 0 1 1-1h3.6l1.8 2h5.6a1 1 0 0 1 1 1v1',
  frame:
    'M3 7V4a1 1 0 0 1 1-1h3M13 3h3a1 1 0 0 1 1 1v3M17 13v3a1 1 0 0 1-1 1h-3M7 17H4a1 1 0 0 1-1-1v-3M7.5 10a2.5 2.5 0 1 0 5 0 2.5 2.5 0 1 0-5 0',
  reset: 'M4 10a6.2 6.2 0 1 0 2-4.5M4 3.2v3.3h3.3',
  flip: 'M2.5 10h15M6 6.8 10 3l4 3.8M6 13.2l4 3.8 4-3.8',
  fewer: 'M5 10h10',
  moreFigures: 'M5 10h10M10 5v10',
  view: 'M2 10s3-5.2 8-5.2 8 5.2 8 5.2-3 5.2-8 5.2S2 10 2 10M7.6 10a2.4 2.4 0 1 0 4.8 0 2.4 2.4 0 1 0-4.8 0',
  mode: 'M2.6 8.2a4.9 3.4 0 1 0 9.8 0 4.9 3.4 0 1 0-9.8 0M8.4 12.6a4.5 3.1 0 1 0 9 0 4.5 3.1 0 1 0-9 0',
  hidden: 'M2 10s3-5.2 8-5.2 8 5.2 8 5.2-3 5.2-8 5.2S2 10 2 10M4 16.5l12-13',
  clouds: 'm10 3-7.5 3.8L10 10.5l7.5-3.7zM2.5 10l7.5 3.7 7.5-3.7M2.5 13.2 10 17l7.5-3.8',
  add: 'M10 4v12M4 10h12',
  fly: 'm2.5 10.5 15-7-5 14-3-5.5zM9.5 12l8-8.5',
  fullscreen: 'M3 7.5V3h4.5M12.5 3H17v4.5M17 12.5V17h-4.5M7.5 17H3v-4.5',
  focus: 'M10 2.5v4M10 13.5v4M2.5 10h4M13.5 10h4M9.5 10h1',
  inspect: 'M8.5 3a5.5 5.5 0 1 0 0 11 5.5 5.5 0 1 0 0-11M12.5 12.5 17 17M6.2 8.5h4.6M8.5 6.2v4.6',
  hud: 'M4 16.5v-5M8 16.5V7M12 16.5v-7M16 16.5v-13',
  accuracy: 'M3 3v13a1 1 0 0 0 1 1h13M7.4 7.2v.1M10.2 11.2v.1M13 8.6v.1M15.8 13.6v.1',
  effects:
    'M8.5 3.5 10.2 8.3 15 10l-4.8 1.7-1.7 4.8-1.7-4.8L2 10l4.8-1.7zM15.5 13.2v4.2M13.4 15.3h4.2M15.5 2.6v4.2M13.4 4.7h4.2',
  save: 'M10 3v9.5M6 9l4 3.8L14 9M3.5 13.5V16a1 1 0 0 0 1 1h11a1 1 0 0 0 1-1v-2.5',
  link: 'M8.3 11.7a3.2 3.2 0 0 0 4.6 0l3-3a3.2 3.2 0 0 0-4.6-4.6l-1 1M11.7 8.3a3.2 3.2 0 0 0-4.6 0l-3 3a3.2 3.2 0 0 0 4.6 4.6l1-1',
  theme: 'M10 3v14M10 3a7 7 0 1 0 0 14 7 7 0 1 0 0-14M13 4v12M16 6.5v7',
  help: 'M7.4 7.4a2.7 2.7 0 1 1 4 2.4c-.9.5-1.4 1.1-1.4 2.1M10 14.6v.2M10 2.5a7.5 7.5 0 1 0 0 15 7.5 7.5 0 1 0 0-15',
  more: 'm6 8 4 4 4-4',
  menu: 'M4.3 10a.7.7 0 1 0 1.4 0 .7.7 0 1 0-1.4 0M9.3 10a.7.7 0 1 0 1.4 0 .7.7 0 1 0-1.4 0M14.3 10a.7.7 0 1 0 1.4 0 .7.7 0 1 0-1.4 0',
  previous: 'M12 5.5 7.5 10l4.5 4.5',
  next: 'm8 5.5 4.5 4.5L8 14.5',
  close: 'm5.5 5.5 9 9m0-9-9 9',
  warning: 'M10 3.2 18 16.8H2zM10 8.2v4M10 14.4v.2',
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg
      viewBox="0 0 20 20"
      width="20"
      height="20"
      fill="none"
      stroke="currentColor"
      strokeWidth="1.6"
      strokeLinecap="round"
      strokeLinejoin="round"
      aria-hidden="true"
    >
      <path d={PATHS[name]} />
    </svg>
  );
}
