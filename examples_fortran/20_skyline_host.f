C     20 Example 18 in a code of the 1980s: profile of K in COMMON.
C
C     A block with a crowned foot is pressed on another block and pushed
C     along it by 1.5 times its width, with friction: meshes, material,
C     load steps and iterations are those of 18_sliding_blocks, and so
C     are the forces. FORTRAN 77, fixed form, all data in COMMON.
C     The host stores the upper triangle of K column by column, each
C     column from the diagonal up to its first entry, in A; MAXA(J) is
C     the address of the diagonal entry of column J, MAXA(NEQ+1) the end
C     (K.-J. Bathe, program COLSOL). The library takes both arrays as
C     they are. Supports have equation number 0, as usual.
C
C     CONTCT, between the two marks below, is everything that contact
C     adds to the host: from coordinates, faces, K and supports to
C     pressures and resultant. Units: N, mm, MPa; 1 mm thick. NB nodes
C     belong to the lower block, N counts unknowns, also those held.
C
C     Known by hand: when the block slides, nodes of its foot that touch
C     have the shear mu x pressure, against the motion; the resultant on
C     the foot holds the forces at the top.
      PROGRAM SKYHST
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      INCLUDE 'feti_contact_f77.inc'
      PARAMETER (NBX = 40, NBY = 5, NAX = 16, NAY = 8)
      PARAMETER (NB = (NBX + 1) * (NBY + 1), NA = (NAX + 1) * (NAY + 1))
      PARAMETER (N = 2 * (NB + NA), NSTEP = 7, MOST = 20, RMU = 0.3D0)
      COMMON /MOTION/ XNOW(N), XLEFT(N), D(N), FINT(N), F(N)
      COMMON /RESULT/ PRESS(N / 2), SHEAR(2, N / 2), STATE(N / 2),
     &  RPAIR(FTNRPF), RINFO(FTNRIN), NPAIR(FTNIPF), INFO(FTNINF)
      LOGICAL SLIDES

      CALL MESH
      CALL GOALS(0)
      CALL ASSEMB
      CALL CONTCT(1)
      LONG = 0
      DO 30 ISTEP = 0, NSTEP - 1
        CALL CONTCT(2)
        ITER = 0
   10   ITER = ITER + 1
        CALL GOALS(ISTEP)
        CALL ASSEMB
        CALL CONTCT(4)
        CHANGE = 0D0
        DO 20 I = 1, N
          XNOW(I) = XNOW(I) + D(I)
   20     CHANGE = MAX(CHANGE, ABS(D(I)))
        IF (CHANGE .GT. 1D-9 .AND. ITER .LT. MOST) GO TO 10
        LONG = MAX(LONG, ITER)
        CALL CONTCT(5)
        WRITE (*, 100) ISTEP, ITER, NPAIR(FTQCLO), NPAIR(FTQSLP),
     &    RPAIR(FTQFOR + 1), RPAIR(FTQFOR)
   30 CONTINUE
      CALL CONTCT(3)

C     The top of the upper block, and the nodes of its foot.
      CALL ASSEMB
      HELDX = 0D0
      HELDY = 0D0
      DO 40 I = N - 2 * NAX - 1, N, 2
        HELDX = HELDX + FINT(I)
   40   HELDY = HELDY + FINT(I + 1)
      ERR = HYP(HELDX + RPAIR(FTQFOR), HELDY + RPAIR(FTQFOR + 1))
     &  / HYP(HELDX, HELDY)
      SLIDES = NPAIR(FTQCLO) .GT. 3 .AND. LONG .LT. MOST
      DO 50 I = NB + 1, NB + NAX + 1
        IF (STATE(I) .EQ. 0D0) GO TO 50
        SLIDES = SLIDES .AND. STATE(I) .EQ. 3D0 .AND. SHEAR(1, I) .LT. 0
        ERR = MAX(ERR, ABS(HYP(SHEAR(1, I), SHEAR(2, I))
     &    - RMU * PRESS(I)) / (RMU * RPAIR(FTQPRE)))
   50 CONTINUE
      CALL SHOW('most iterations of a load step', DBLE(LONG), '-')
      CALL SHOW('largest pressure', RPAIR(FTQPRE), 'MPa')
      CALL SHOW('force on the foot, up', RPAIR(FTQFOR + 1), 'N')
      CALL SHOW('force on the foot, along', RPAIR(FTQFOR), 'N')
      CALL SHOW('area that touches', RPAIR(FTQARE), 'mm2')
      CALL DEMO(INFO, RINFO, ERR, SLIDES)
  100 FORMAT ('step', I2, ':', I3, ' iterations,', I3, ' nodes touch,',
     &  I3, ' slip, force on the foot', F12.6, ' N up,', F12.6,
     &  ' N along')
      END

C     ---- Contact: all that the host needs of the library. ----
C     JOB 1 begins, 2 begins a load step, 3 ends; 4 solves for the
C     increment D at the positions XNOW, 5 reads the results there.
      SUBROUTINE CONTCT(JOB)
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      INCLUDE 'feti_contact_f77.inc'
      PARAMETER (NBX = 40, NAX = 16, NB = 41 * 6, N = 2 * (NB + 17 * 9),
     &  NEL = 200 + 128, MWK = 60000, RMU = 0.3D0)
      COMMON /MESHES/ X(N), NUM(N), NPTR(N + 1), NOWN(N),
     &  NCORN(4, NEL), NBELOW(2, NBX), NFOOT(2, NAX), NEQ
      COMMON /STIFF/ A(MWK), MAXA(N + 1)
      COMMON /MOTION/ XNOW(N), XLEFT(N), D(N), FINT(N), F(N)
      COMMON /RESULT/ PRESS(N / 2), SHEAR(2, N / 2), STATE(N / 2),
     &  RPAIR(FTNRPF), RINFO(FTNRIN), NPAIR(FTNIPF), INFO(FTNINF)
      COMMON /KEPT/ IP, IBODY, ILOW, IFOOT, IPAIR
      DIMENSION IWORD(2), DWORD(2)
      DATA IWORD / 1, 2 /, DWORD / 1D0, 2D0 /
      IERR = 0
      IF (JOB .EQ. 1) THEN
        CALL FTNEW(IWORD, DWORD, IP, IERR)
        IF (IERR .EQ. 0) CALL FTBADD(IP, NEQ, IBODY, IERR)
        IF (IERR .EQ. 0) CALL FTBSKY(IP, IBODY, NEQ, MAXA, A, FTSKUP,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTDTAB(IP, N, NUM, NPTR, NUM, A, XLEFT,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTSADD(IP, FTALL, 2, N / 2, X, 2, NOWN, 2,
     &    ILOW, IERR)
        IF (IERR .EQ. 0) CALL FTSFAC(IP, ILOW, FTLIN2, NBX, NBELOW,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTSADD(IP, FTALL, 2, N / 2, X, 2, NOWN, 2,
     &    IFOOT, IERR)
        IF (IERR .EQ. 0) CALL FTSFAC(IP, IFOOT, FTLIN2, NAX, NFOOT,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTPADD(IP, IFOOT, ILOW, FTNTOF, 1D0,
     &    IPAIR, IFIRST, IERR)
        IF (IERR .EQ. 0) CALL FTPVAL(IP, IPAIR, 'friction', 1, RMU,
     &    IERR)
      END IF
      IF (JOB .EQ. 2) CALL FTPCMT(IP, IERR)
      IF (JOB .EQ. 3) CALL FTFREE(IP, IERR)
      IF (JOB .GE. 4) CALL FTSMOV(IP, ILOW, XNOW, 2, IERR)
      IF (JOB .GE. 4 .AND. IERR .EQ. 0) CALL FTSMOV(IP, IFOOT, XNOW, 2,
     &  IERR)
      IF (JOB .EQ. 4) THEN
        IF (IERR .EQ. 0) CALL FTDTAB(IP, N, NUM, NPTR, NUM, A, XLEFT,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTPFND(IP, IERR)
        IF (IERR .EQ. 0) CALL FTBVAL(IP, IBODY, MAXA(NEQ + 1) - 1, A,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTBLOD(IP, FTALL, N, F, IERR)
        IF (IERR .EQ. 0) CALL FTSOLV(IP, FTNINF, INFO, FTNRIN, RINFO,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTDISP(IP, FTALL, N, D, IERR)
      ELSE IF (JOB .EQ. 5) THEN
        IF (IERR .EQ. 0) CALL FTPFLD(IP, IPAIR, FTVPRE, N / 2, PRESS,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTPFLD(IP, IPAIR, FTVSHE, N, SHEAR, IERR)
        IF (IERR .EQ. 0) CALL FTPFLD(IP, IPAIR, FTVCLO, N / 2, STATE,
     &    IERR)
        IF (IERR .EQ. 0) CALL FTPINF(IP, IPAIR, FTNIPF, NPAIR, FTNRPF,
     &    RPAIR, IERR)
      END IF
      CALL SURE(IERR)
      END
C     ---- End of contact. ----

C     Both blocks: NUM is the equation of each direction of a node, 0 if
C     it is held; NCORN the corners of elements, counterclockwise. Faces
C     have the body on their left: NBELOW goes backwards along the top
C     of the lower block, NFOOT forwards along the foot of the upper.
C     NPTR: no unknown is a combination of others. A column of K begins
C     with the smallest equation in an element of its own.
      SUBROUTINE MESH
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      PARAMETER (NBX = 40, NBY = 5, NAX = 16, NAY = 8)
      PARAMETER (NB = (NBX + 1) * (NBY + 1), NA = (NAX + 1) * (NAY + 1))
      PARAMETER (N = 2 * (NB + NA), NEL = 200 + 128, MWK = 60000)
      COMMON /MESHES/ X(N), NUM(2, N / 2), NPTR(N + 1), NOWN(N),
     &  NCORN(4, NEL), NBELOW(2, NBX), NFOOT(2, NAX), NEQ
      COMMON /STIFF/ A(MWK), MAXA(N + 1)
      COMMON /MOTION/ XNOW(N), XLEFT(N), D(N), FINT(N), F(N)
      NEQ = 0
      CALL BLOCK(0, 0, NBX, NBY, 0)
      CALL BLOCK(NB, NBX * NBY, NAX, NAY, NAY)
      NPTR(N + 1) = 1
      DO 10 I = 1, N
        NOWN(I) = I
        NPTR(I) = 1
   10   XNOW(I) = X(I)
      DO 20 I = 1, NBX
        NBELOW(1, I) = NBY * (NBX + 1) + I + 1
   20   NBELOW(2, I) = NBY * (NBX + 1) + I
      DO 30 I = 1, NAX
        NFOOT(1, I) = NB + I
   30   NFOOT(2, I) = NB + I + 1
      DO 40 I = 1, NEQ + 1
   40   MAXA(I) = 1
      DO 70 L = 1, NEL
        LEAST = NEQ
        DO 50 K = 1, 4
          DO 50 J = 1, 2
            I = NUM(J, NCORN(K, L))
   50       IF (I .GT. 0) LEAST = MIN(LEAST, I)
        DO 60 K = 1, 4
          DO 60 J = 1, 2
            I = NUM(J, NCORN(K, L))
   60       IF (I .GT. 0) MAXA(I + 1) = MAX(MAXA(I + 1), I - LEAST + 1)
   70   CONTINUE
      DO 80 I = 1, NEQ
   80   MAXA(I + 1) = MAXA(I) + MAXA(I + 1)
      IF (MAXA(NEQ + 1) .GT. MWK + 1) STOP 2
      END

C     Nodes NFIRST + 1, ... row by row from below, the row JHELD held;
C     elements IEL + 1, ... of a block of NX by NY.
      SUBROUTINE BLOCK(NFIRST, IEL, NX, NY, JHELD)
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      PARAMETER (NBX = 40, NAX = 16, NB = 41 * 6, N = 2 * (NB + 17 * 9),
     &  NEL = 200 + 128)
      COMMON /MESHES/ X(2, N / 2), NUM(2, N / 2), NPTR(N + 1), NOWN(N),
     &  NCORN(4, NEL), NBELOW(2, NBX), NFOOT(2, NAX), NEQ
      NODE = NFIRST
      DO 10 J = 0, NY
        DO 10 I = 0, NX
          NODE = NODE + 1
          S = DBLE(I) / NX
          T = DBLE(J) / NY
          X(1, NODE) = 40D0 * S
          X(2, NODE) = 8D0 * T
          IF (NFIRST .GT. 0) THEN
            X(1, NODE) = 6D0 + 10D0 * S
            X(2, NODE) = 8D0 + 6D0 * T
     &        + (1D0 - T) * (10D0 * (S - 0.5D0))**2 / 120D0
          END IF
          NUM(1, NODE) = 0
          NUM(2, NODE) = 0
          IF (J .EQ. JHELD) GO TO 10
          NUM(1, NODE) = NEQ + 1
          NUM(2, NODE) = NEQ + 2
          NEQ = NEQ + 2
   10   CONTINUE
      DO 30 J = 1, NY
        DO 30 I = 1, NX
          L = IEL + (J - 1) * NX + I
          NCORN(1, L) = NFIRST + (J - 1) * (NX + 1) + I
          NCORN(2, L) = NCORN(1, L) + 1
          NCORN(3, L) = NCORN(2, L) + NX + 1
   30     NCORN(4, L) = NCORN(1, L) + NX + 1
      END

C     XLEFT: what held unknowns still have to go in a load step. The top
C     of the upper block goes down in the first step, then along.
      SUBROUTINE GOALS(ISTEP)
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      PARAMETER (NBX = 40, NAX = 16, NB = 41 * 6, N = 2 * (NB + 17 * 9),
     &  NEL = 200 + 128)
      COMMON /MESHES/ X(N), NUM(N), NPTR(N + 1), NOWN(N),
     &  NCORN(4, NEL), NBELOW(2, NBX), NFOOT(2, NAX), NEQ
      COMMON /MOTION/ XNOW(N), XLEFT(N), D(N), FINT(N), F(N)
      DO 10 I = 1, N
        XLEFT(I) = 0D0
        IF (NUM(I) .GT. 0) GO TO 10
        XLEFT(I) = X(I) - XNOW(I)
        IF (I .LE. 2 * NB) GO TO 10
        IF (MOD(I, 2) .EQ. 1) XLEFT(I) = XLEFT(I) + 15D0 * ISTEP / 6D0
        IF (MOD(I, 2) .EQ. 0) XLEFT(I) = XLEFT(I) - 0.25D0
   10 CONTINUE
      END

C     A, internal forces FINT and load F at the positions XNOW. F: minus
C     FINT, and minus the part of K that acts on XLEFT.
      SUBROUTINE ASSEMB
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      PARAMETER (NBX = 40, NAX = 16, NB = 41 * 6, N = 2 * (NB + 17 * 9),
     &  NEL = 200 + 128, MWK = 60000)
      COMMON /MESHES/ X(N), NUM(N), NPTR(N + 1), NOWN(N),
     &  NCORN(4, NEL), NBELOW(2, NBX), NFOOT(2, NAX), NEQ
      COMMON /STIFF/ A(MWK), MAXA(N + 1)
      COMMON /MOTION/ XNOW(N), XLEFT(N), D(N), FINT(N), F(N)
      DIMENSION AE(8, 8), FE(8), X0(8), X1(8), LM(8)
      GAUSS = SQRT(1D0 / 3D0)
      DO 10 I = 1, MAXA(NEQ + 1) - 1
   10   A(I) = 0D0
      DO 20 I = 1, N
        FINT(I) = 0D0
   20   F(I) = 0D0
      DO 60 L = 1, NEL
        DO 30 K = 1, 4
          DO 30 J = 1, 2
            I = 2 * K - 2 + J
            LM(I) = 2 * NCORN(K, L) - 2 + J
            X0(I) = X(LM(I))
            X1(I) = XNOW(LM(I))
            FE(I) = 0D0
            DO 30 M = 1, 8
   30         AE(I, M) = 0D0
        CALL POINT(X0, X1, -GAUSS, -GAUSS, AE, FE)
        CALL POINT(X0, X1, GAUSS, -GAUSS, AE, FE)
        CALL POINT(X0, X1, -GAUSS, GAUSS, AE, FE)
        CALL POINT(X0, X1, GAUSS, GAUSS, AE, FE)
        DO 50 I = 1, 8
          FINT(LM(I)) = FINT(LM(I)) + FE(I)
          F(LM(I)) = F(LM(I)) - FE(I)
          II = NUM(LM(I))
          DO 40 J = 1, 8
            F(LM(I)) = F(LM(I)) - AE(I, J) * XLEFT(LM(J))
            JJ = NUM(LM(J))
            IF (II .LE. 0 .OR. JJ .LT. II) GO TO 40
            A(MAXA(JJ) + JJ - II) = A(MAXA(JJ) + JJ - II) + AE(I, J)
   40     CONTINUE
   50   CONTINUE
   60 CONTINUE
      END

C     Adds one point of integration: F = sum x(a) g(a)', Green's strain
C     E = (F'F - I)/2, stress S = lame tr(E) I + 2 shear E (material of
C     St. Venant and Kirchhoff, plane strain),
C         f(a) = w F S g(a)
C         K(a,b) = w (lame F g(a) (F g(b))'
C                     + shear (F g(b) (F g(a))' + g(a)'g(b) F F')
C                     + g(a)'S g(b) I)
      SUBROUTINE POINT(X0, X1, S, T, AE, FE)
      IMPLICIT DOUBLE PRECISION (A-H, O-Z)
      PARAMETER (YOUNG = 1D3, POISS = 0.3D0)
      PARAMETER (SHM = YOUNG / (2D0 * (1D0 + POISS)))
      PARAMETER (RLAME = 2D0 * SHM * POISS / (1D0 - 2D0 * POISS))
      DIMENSION X0(2, 4), X1(2, 4), AE(2, 4, 2, 4), FE(2, 4)
      DIMENSION PLACE(2, 4), SL(2, 4), G(2, 4), RJ(2, 2), F(2, 2)
      DIMENSION FF(2, 2), ST(2, 2), SG(2, 4), FG(2, 4)
      DATA PLACE / -1D0, -1D0, 1D0, -1D0, 1D0, 1D0, -1D0, 1D0 /
      DO 10 I = 1, 2
        DO 10 J = 1, 2
          RJ(I, J) = 0D0
   10     F(I, J) = 0D0
      DO 20 K = 1, 4
        SL(1, K) = PLACE(1, K) * (1D0 + PLACE(2, K) * T) / 4D0
        SL(2, K) = PLACE(2, K) * (1D0 + PLACE(1, K) * S) / 4D0
        DO 20 I = 1, 2
          DO 20 J = 1, 2
   20       RJ(I, J) = RJ(I, J) + SL(I, K) * X0(J, K)
      W = RJ(1, 1) * RJ(2, 2) - RJ(1, 2) * RJ(2, 1)
      DO 30 K = 1, 4
        G(1, K) = (RJ(2, 2) * SL(1, K) - RJ(1, 2) * SL(2, K)) / W
        G(2, K) = (RJ(1, 1) * SL(2, K) - RJ(2, 1) * SL(1, K)) / W
        DO 30 I = 1, 2
          DO 30 J = 1, 2
   30       F(I, J) = F(I, J) + X1(I, K) * G(J, K)
      TRACE = (F(1, 1)**2 + F(1, 2)**2 + F(2, 1)**2 + F(2, 2)**2
     &  - 2D0) / 2D0
      DO 50 I = 1, 2
        DO 40 J = 1, 2
          FF(I, J) = F(I, 1) * F(J, 1) + F(I, 2) * F(J, 2)
   40     ST(I, J) = SHM * (F(1, I) * F(1, J) + F(2, I) * F(2, J))
   50   ST(I, I) = ST(I, I) - SHM + RLAME * TRACE
      DO 60 K = 1, 4
        DO 60 I = 1, 2
          SG(I, K) = ST(I, 1) * G(1, K) + ST(I, 2) * G(2, K)
   60     FG(I, K) = F(I, 1) * G(1, K) + F(I, 2) * G(2, K)
      DO 90 K = 1, 4
        DO 90 I = 1, 2
          FE(I, K) = FE(I, K) + W * (F(I, 1) * SG(1, K)
     &      + F(I, 2) * SG(2, K))
          DO 80 L = 1, 4
            GG = G(1, K) * G(1, L) + G(2, K) * G(2, L)
            GSG = SG(1, K) * G(1, L) + SG(2, K) * G(2, L)
            DO 70 J = 1, 2
   70         AE(I, K, J, L) = AE(I, K, J, L) + W * (RLAME * FG(I, K)
     &          * FG(J, L) + SHM * (FG(I, L) * FG(J, K)
     &          + GG * FF(I, J)))
   80       AE(I, K, I, L) = AE(I, K, I, L) + W * GSG
   90     CONTINUE
      END

      DOUBLE PRECISION FUNCTION HYP(X, Y)
      DOUBLE PRECISION X, Y
      HYP = SQRT(X * X + Y * Y)
      END

C     Ends the program with the words of the library if a call fails.
      SUBROUTINE SURE(IERR)
      CHARACTER*300 TEXT
      IF (IERR .EQ. 0) RETURN
      CALL FTERR(IERR, TEXT)
      WRITE (*, *) TEXT
      STOP 1
      END

C     One result: name, value, unit, as example 18 prints it.
      SUBROUTINE SHOW(NAME, VALUE, UNIT)
      CHARACTER*(*) NAME, UNIT
      CHARACTER*32 LABEL
      DOUBLE PRECISION VALUE
      LABEL = NAME
      WRITE (*, 10) LABEL, VALUE, UNIT
   10 FORMAT (A32, F16.6, 1X, A)
      END

C     The demo line, as example 18 prints it.
      SUBROUTINE DEMO(INFO, RINFO, ERR, CHECKS)
      INCLUDE 'feti_contact_f77.inc'
      INTEGER INFO(FTNINF), I
      DOUBLE PRECISION RINFO(FTNRIN), ERR, CERT, SECS
      LOGICAL CHECKS
      CERT = MAX(RINFO(FTRCON), RINFO(FTRWRK), RINFO(FTRSTK))
      DO 10 I = FTREQM, FTRGAP
   10   CERT = MAX(CERT, RINFO(I))
      CHECKS = CHECKS .AND. INFO(FTISTA) .EQ. FTOK
     &  .AND. RINFO(FTRWOR) .LE. 1D0 .AND. ERR .LE. 1D-7
      SECS = RINFO(FTRSUP) + RINFO(FTRSOL)
      IF (CHECKS) WRITE (*, 20) INFO(FTIDOF), INFO(FTIROW),
     &  INFO(FTIACT), CERT, ERR, SECS, 'ok'
      IF (.NOT. CHECKS) WRITE (*, 20) INFO(FTIDOF), INFO(FTIROW),
     &  INFO(FTIACT), CERT, ERR, SECS, 'short'
   20 FORMAT ('demo 20_skyline_host fortran unknowns', I4, ' rows', I3,
     &  ' active', I3, ' certificate', 1PE8.1, ' error', E8.1,
     &  ' seconds', 0PF6.3, 1X, A)
      IF (.NOT. CHECKS) STOP 1
      END
