# gnuplot validation/models.gp, from the root of the repository: the figures of docs/explanation/models.md from the committed results.
set datafile separator ','
set terminal svg noenhanced size 800,520 font 'DejaVu Sans,14' background '#ffffff'
set grid lc rgb '#dddddd'
of_size(n) = sprintf('< awk -F, ''$1==%s'' validation/results/vicsek_noise.csv', n)

set output 'docs/images/vicsek_noise.svg'
set title 'Vicsek model: order against noise, density 4'
set xlabel 'noise η'
set ylabel 'order v_a'
set xrange [0:5]
set yrange [0:1]
set key bottom left
set arrow from 2.9, 0 to 2.9, 1 nohead dt 2 lc rgb '#888888'
set label 'η_c(∞) = 2.9' at 2.95, 0.95 tc rgb '#666666'
plot for [n in '40 100 400 4000 10000'] of_size(n) using 3:4:5 with yerrorlines pt 7 ps 0.5 title n.' agents'

set output 'docs/images/vicsek_density.svg'
unset arrow
unset label
set title 'Vicsek model: order against density, side 20, η = 2'
set xlabel 'density ρ'
set xrange [0:10]
set key off
plot 'validation/results/vicsek_density.csv' skip 1 using 3:4:5 with yerrorlines pt 7 ps 0.5

set output 'docs/images/epidemic_sir.svg'
set title 'Epidemic among fast walkers, three seeds, and the SIR equations'
set xlabel 'time'
set ylabel 'agents'
set xrange [0:50]
set yrange [0:10000]
set key right center
of_seed(n) = sprintf('< awk -F, ''$1=="seed=%s"'' validation/results/epidemic.csv', n)
sir = 'validation/results/sir.csv'
plot for [n in '1 2 3'] of_seed(n) using 2:3 with lines lw 3 lc rgb '#9ecae8' title (n eq '1' ? 'susceptible' : ''), \
     for [n in '1 2 3'] of_seed(n) using 2:4 with lines lw 3 lc rgb '#f3c19b' title (n eq '1' ? 'infected' : ''), \
     for [n in '1 2 3'] of_seed(n) using 2:5 with lines lw 3 lc rgb '#9fdcc7' title (n eq '1' ? 'recovered' : ''), \
     for [c = 2:4] sir skip 1 using 1:c with lines lw 1 lc rgb '#000000' title (c == 2 ? 'SIR equations' : '')
