// Line drawings in the colour of the text around them; the words beside them carry the meaning.
const PATHS = {
  sun: 'M12 4V2m0 20v-2m8-8h2M2 12h2m13.700-5.700 1.400-1.400M4.900 19.100l1.400-1.400m0-11.400L4.900 4.900m14.200 14.200-1.400-1.400M16 12a4 4 0 1 1-8 0 4 4 0 0 1 8 0z',
  moon: 'M20 14.500A8.500 8.500 0 0 1 9.500 4a8.500 8.500 0 1 0 10.500 10.500z',
  key: 'M11.500 15.500a4.500 4.500 0 1 1-9 0 4.500 4.500 0 0 1 9 0zM10.200 12.300 20 2.500M16 6.500l3.500 3.500M13 9.500l2 2',
  upload: 'M12 16V4m0 0L7 9m5-5 5 5M4 16v3a1 1 0 0 0 1 1h14a1 1 0 0 0 1-1v-3',
  download: 'M12 4v12m0 0 5-5m-5 5-5-5M4 17v2a1 1 0 0 0 1 1h14a1 1 0 0 0 1-1v-2',
  check: 'M5 12.500l4.500 4.500L19 7.500',
  pause: 'M9 5v14M15 5v14',
  play: 'M7 5l12 7-12 7z',
  stop: 'M8.200 3h7.600L21 8.200v7.600L15.800 21H8.200L3 15.800V8.200zM12 8v5m0 3h.01',
  close: 'M6 6l12 12M18 6L6 18',
  again: 'M4 12a8 8 0 1 0 2.700-6M4 4v4.500h4.500',
  hold: 'M12 7v5l3 2m6-2a9 9 0 1 1-18 0 9 9 0 0 1 18 0z',
  warning: 'M12 9v4.500m0 3.500h.01M10.300 4 2.600 17.500A2 2 0 0 0 4.300 20.500h15.400a2 2 0 0 0 1.700-3L13.700 4a2 2 0 0 0-3.400 0z',
  first: 'M6 4h12M12 20V9m0 0-5 5m5-5 5 5',
  bed: 'M3 18h18M6 18v-3h12v3m-9-7 3 3m0 0 6-7',
  back: 'M19 12H5m0 0 6-6m-6 6 6 6',
  cube: 'M12 3l8 4.500v9L12 21l-8-4.500v-9zM4 7.500l8 4.500 8-4.500M12 12v9',
} as const;

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class="icon" viewBox="0 0 24 24" aria-hidden="true" focusable="false">
      <path d={PATHS[name]} />
    </svg>
  );
}

export function Mark() {
  return (
    <svg class="mark" viewBox="0 0 32 32" aria-hidden="true" focusable="false">
      <rect width="32" height="32" rx="7" class="mark-ground" />
      <path d="M6 25.500h20" class="mark-plate" />
      <path d="M8 21.500V13h7v8.500z" class="mark-a" />
      <path d="M16.500 21.500V7.500H24v6h-3.200v8z" class="mark-b" />
      <path d="M22.300 21.500v-6.400H24v6.400z" class="mark-c" />
    </svg>
  );
}
